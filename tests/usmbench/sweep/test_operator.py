import io
import os
import select
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from usmbench.errors import BenchError
from usmbench.sweep.operator import TerminalOperator


@pytest.fixture
def pipe() -> Iterator[tuple[int, int]]:
    read, write = os.pipe()
    yield read, write
    for end in (read, write):
        try:
            os.close(end)
        except OSError:
            continue


def wait_for(operator: TerminalOperator) -> None:
    deadline_s = time.monotonic() + 5.0
    while not operator.load_is_set():
        assert time.monotonic() < deadline_s
        time.sleep(0.001)


def test_enter_says_that_each_load_is_set(pipe: tuple[int, int]) -> None:
    output = io.StringIO()
    operator = TerminalOperator(output, pipe[0])
    for torque_nm in (0.1, 0.2):
        operator.set_load(torque_nm, ask=True)
        assert not operator.load_is_set()
        os.write(pipe[1], b"done\n")
        wait_for(operator)
        assert f"{torque_nm:g} N·m" in output.getvalue()
    assert operator.load_is_set()


def type_ahead(pipe: tuple[int, int]) -> None:
    """Press Enter while nothing is asked, and let the reader, if there is one, have it."""
    os.write(pipe[1], b"\n")
    deadline_s = time.monotonic() + 0.2
    while time.monotonic() < deadline_s and select.select([pipe[0]], [], [], 0.0)[0]:
        time.sleep(0.001)
    time.sleep(0.1)


def stays_open(operator: TerminalOperator) -> bool:
    time.sleep(0.1)
    return not operator.load_is_set()


@pytest.mark.parametrize("times", [1, 3])
def test_enter_before_the_question_answers_nothing(pipe: tuple[int, int], times: int) -> None:
    operator = TerminalOperator(io.StringIO(), pipe[0])
    for torque_nm in (0.1, 0.2):
        # Before the first question nobody reads, before the second somebody does.
        for _ in range(times):
            type_ahead(pipe)
        operator.set_load(torque_nm, ask=True)
        assert stays_open(operator)
        os.write(pipe[1], b"\n")
        wait_for(operator)


def test_input_that_never_runs_dry_does_not_hold_the_sweep_up() -> None:
    with Path("/dev/zero").open("rb") as endless:
        TerminalOperator(io.StringIO(), endless.fileno())._drop_unread()


def test_the_last_word_is_an_answer(pipe: tuple[int, int]) -> None:
    operator = TerminalOperator(io.StringIO(), pipe[0])
    operator.set_load(0.1, ask=True)
    os.write(pipe[1], b"\n")
    os.close(pipe[1])
    time.sleep(0.1)
    assert operator.load_is_set()
    operator.set_load(0.2, ask=True)
    with pytest.raises(BenchError, match="nobody"):
        wait_for(operator)


def test_a_constant_load_needs_nobody(pipe: tuple[int, int]) -> None:
    output = io.StringIO()
    operator = TerminalOperator(output, pipe[0])
    operator.set_load(0.1, ask=False)
    assert operator.load_is_set()
    assert output.getvalue() == ""


def test_nobody_there_is_told(pipe: tuple[int, int]) -> None:
    operator = TerminalOperator(io.StringIO(), pipe[0])
    os.close(pipe[1])
    operator.set_load(0.1, ask=True)
    with pytest.raises(BenchError, match="load: constant"):
        wait_for(operator)


def test_a_question_that_nobody_can_see_is_told(pipe: tuple[int, int]) -> None:
    os.close(pipe[0])
    output = io.FileIO(pipe[1], "w", closefd=False)
    operator = TerminalOperator(io.TextIOWrapper(output, write_through=True), pipe[0])
    with pytest.raises(BenchError, match=r"nobody .*standard error .*Broken pipe.*load: constant"):
        operator.set_load(0.1, ask=True)
