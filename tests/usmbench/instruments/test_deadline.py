import threading
import time

import pytest

from usmbench.instruments.deadline import run_within


def test_returns_what_the_work_returns() -> None:
    assert run_within(5.0, lambda: 42) == 42


def test_raises_what_the_work_raises() -> None:
    def fail() -> None:
        raise KeyError("card")

    with pytest.raises(KeyError, match="card"):
        run_within(5.0, fail)


def test_leaves_slow_work_behind_and_releases_what_it_brings_late() -> None:
    go_on, released = threading.Event(), threading.Event()
    late: list[str] = []

    def slow() -> str:
        go_on.wait(10.0)
        return "tasks"

    def release(result: str) -> None:
        late.append(result)
        released.set()

    started_s = time.monotonic()
    with pytest.raises(TimeoutError):
        run_within(0.05, slow, too_late=release)
    assert time.monotonic() - started_s < 5.0
    assert late == []
    go_on.set()
    assert released.wait(5.0)
    assert late == ["tasks"]


def test_late_failure_releases_nothing() -> None:
    go_on, ended = threading.Event(), threading.Event()
    late: list[None] = []

    def slow() -> None:
        go_on.wait(10.0)
        ended.set()
        raise OSError

    with pytest.raises(TimeoutError):
        run_within(0.05, slow, too_late=late.append)
    go_on.set()
    assert ended.wait(5.0)
    assert late == []
