"""Ctrl-C at any instant: the drive is off, and what was measured is there."""

import signal
import sys
import threading
from types import FrameType
from typing import Any

import pytest

from usmbench.settings.bench import BenchSettings, InterlockSettings
from usmbench.settings.plan_file import parse_plan
from usmbench.settings.yaml_source import Source
from usmbench.sweep.controller import SweepController
from usmbench.sweep.interrupts import deferred_interrupts
from usmbench.sweep.schedule import schedule

PLAN = parse_plan(
    Source(
        "plan.yaml",
        {
            "format": "usmbench-plan/1",
            "frequency_hz": 41000,
            "dwell": {"windows": 12, "settle": {"min_windows": 2, "over_windows": 4}},
            "passes": [{"phase_deg": [-90, 90]}],
            "torque_nm": 0.1,
        },
    )
)
LIMITS = InterlockSettings(motion_off_after_s=0.05)


def sweep(fake: Any, bench_settings: BenchSettings) -> None:
    controller = SweepController(fake.instruments, bench_settings, LIMITS, fake, observer=fake)
    controller.run(schedule(PLAN, 0.01), 50)


def n_calls(make_fake: Any, bench_settings: BenchSettings) -> int:
    fake = make_fake()
    sweep(fake, bench_settings)
    return len(fake.calls)


@pytest.mark.parametrize("times", [1, 3])
def test_a_signal_inside_any_call_ends_with_the_drive_off(
    make_fake: Any, bench_settings: BenchSettings, times: int
) -> None:
    total = n_calls(make_fake, bench_settings)
    stopped = 0
    for n in range(1, total + 1):
        fake = make_fake()

        def interrupt(name: str, fake: Any = fake, n: int = n) -> None:
            if n <= len(fake.calls) < n + times:
                signal.raise_signal(signal.SIGINT)

        fake.hook = interrupt
        try:
            sweep(fake, bench_settings)
        except KeyboardInterrupt:
            stopped += 1
        assert not fake.on
        assert fake.calls[-1] == "off"
        # No row is torn from its raw samples: the wish waits for the window's end.
        assert fake.calls.count("raw") == fake.calls.count("window") == len(fake.windows)
    assert stopped >= total - 10


def test_an_interrupt_that_nothing_defers_ends_with_the_drive_off(
    make_fake: Any, bench_settings: BenchSettings
) -> None:
    total = n_calls(make_fake, bench_settings)
    for n in range(1, total):
        fake = make_fake()

        def interrupt(name: str, fake: Any = fake, n: int = n) -> None:
            if len(fake.calls) == n:
                raise KeyboardInterrupt

        fake.hook = interrupt
        with pytest.raises(KeyboardInterrupt):
            sweep(fake, bench_settings)
        assert not fake.on
        assert "off" in fake.calls[-2:]


def test_a_signal_at_any_line_ends_with_the_drive_off(
    make_fake: Any, bench_settings: BenchSettings
) -> None:
    lines = 0
    fire_at = 0

    def trace(frame: FrameType, event: str, _argument: object) -> Any:
        nonlocal lines
        if "/usmbench/sweep/" not in frame.f_code.co_filename or "conftest" in (
            frame.f_code.co_filename
        ):
            return None
        if event == "line":
            lines += 1
            if lines == fire_at:
                signal.raise_signal(signal.SIGINT)
        return trace

    def traced(at: int) -> tuple[Any, bool]:
        nonlocal lines, fire_at
        lines, fire_at = 0, at
        fake = make_fake()
        before = sys.gettrace()
        sys.settrace(trace)
        try:
            sweep(fake, bench_settings)
        except KeyboardInterrupt:
            return fake, True
        finally:
            sys.settrace(before)
        return fake, False

    traced(0)
    total = lines
    assert total > 1000
    # A stride without a common divisor with the loop's lines visits all of them over the windows.
    for at in range(1, total, 13):
        fake, stopped = traced(at)
        assert not fake.on
        assert not fake.was_on or "off" in fake.calls[fake.calls.index("on") :]
        assert stopped or len(fake.pairs) == 2


def test_handlers_are_put_back_also_after_a_failure() -> None:
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]

    def fail() -> None:
        with deferred_interrupts():
            assert signal.getsignal(signal.SIGTERM) not in before
            raise ValueError("x")

    with pytest.raises(ValueError, match="x"):
        fail()
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] == before


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_every_signal_that_would_end_the_process_waits(name: str) -> None:
    with deferred_interrupts() as interrupts:
        interrupts.check()
        signal.raise_signal(getattr(signal, name))
        with pytest.raises(KeyboardInterrupt):
            interrupts.check()
        interrupts.check()


def test_nested_guards_share_the_wish() -> None:
    with deferred_interrupts() as outer:
        with deferred_interrupts() as inner:
            signal.raise_signal(signal.SIGINT)
            assert inner is outer
        with pytest.raises(KeyboardInterrupt):
            outer.check()


def test_a_closed_terminal_that_is_ignored_stays_ignored() -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with deferred_interrupts() as interrupts:
            signal.raise_signal(signal.SIGHUP)
            interrupts.check()
    finally:
        signal.signal(signal.SIGHUP, before)


def test_other_threads_install_nothing() -> None:
    handlers = []

    def work() -> None:
        with deferred_interrupts():
            handlers.append(signal.getsignal(signal.SIGINT))

    before = signal.getsignal(signal.SIGINT)
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert handlers == [before]
