"""The driver with the emulated board, which was written apart from it: noise, silence, Ctrl-C."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_sim.faults import BYTE_KINDS, Fault, FaultKind
from hil_sim.in_process import InProcessBench
from usmbench.errors import BoardError, BoardResetError
from usmbench.instruments import generator as driver
from usmbench.instruments.generator import SignalGenerator
from usmbench.instruments.protocol._generated import Flags

INSTRUMENTS = driver.__file__.rsplit("/", 1)[0]
STEP_DEG = 360.0 / 4096


def connect(bench: InProcessBench) -> SignalGenerator:
    return SignalGenerator(
        bench.port,
        clock=bench.clock,
        frequency_limits_hz=(40_000.0, 42_000.0),
        phase_limits_deg=(-180.0, 180.0),
    )


def test_what_the_driver_reports_is_what_the_board_has_in_force() -> None:
    generator = connect(InProcessBench())
    with generator:
        generator.set_drive(41_000.0, -33.3)
        generator.outputs_on = True
        status = generator.status()
        assert status.frequency_word_a == status.frequency_word_b == 440234
        assert status.phase_word_a == 0
        assert status.phase_word_b == round(-33.3 / STEP_DEG) & 0xFFF
        assert generator.phase_deg == pytest.approx(-33.3, abs=STEP_DEG / 2)
        assert generator.outputs_on
        generator.off()
        assert generator.status().flags == Flags.CONFIGURED


def test_a_silent_host_hears_of_it_and_can_go_on() -> None:
    bench = InProcessBench()
    bench.source.start()
    with connect(bench) as generator:
        generator.set_drive(41_000.0, 10.0)
        generator.outputs_on = True
        for _ in range(110):
            bench.source.next_block()
        with pytest.raises(BoardError, match="heard nothing"):
            generator.heartbeat()
        assert not generator.outputs_on
        generator.outputs_on = True
        generator.heartbeat()


def test_a_reset_between_two_commands_names_its_cause() -> None:
    bench = InProcessBench(faults=[Fault(FaultKind.BOARD_RESET, 0.05, cause="watchdog")])
    bench.source.start()
    with connect(bench) as generator:
        generator.set_drive(41_000.0, 10.0)
        generator.outputs_on = True
        for _ in range(10):
            bench.source.next_block()
        with pytest.raises(BoardResetError, match="watchdog"):
            generator.phase_deg = 20.0
        generator.reconnect()
        assert generator.frequency_hz == 0.0


byte_faults = st.builds(
    lambda kind, time_s, direction: Fault(kind, time_s, direction=direction),
    st.sampled_from(BYTE_KINDS),
    st.floats(0.0, 0.02),
    st.sampled_from(["to_board", "to_host"]),
)


@settings(deadline=None, max_examples=60)
@given(st.lists(byte_faults, max_size=4), st.lists(st.integers(-2048, 2048), max_size=12))
def test_a_noisy_line_changes_neither_what_is_set_nor_what_is_read(
    faults: list[Fault], words: list[int]
) -> None:
    with connect(InProcessBench(faults=sorted(faults, key=lambda f: f.time_s))) as generator:
        generator.set_drive(41_000.0, 0.0)
        for word in words:
            generator.phase_deg = word * STEP_DEG
            assert generator.status().phase_word_b == word & 0xFFF


class Interrupter:
    """Raises KeyboardInterrupt at the n-th line that the driver executes, once."""

    def __init__(self, line: int):
        self.left = line

    def __call__(self, frame: FrameType, event: str, argument: Any) -> Any:
        if not frame.f_code.co_filename.startswith(INSTRUMENTS):
            return None
        if event == "line":
            self.left -= 1
            if self.left == 0:
                raise KeyboardInterrupt
        return self


@contextmanager
def interrupted(line: int) -> Iterator[Interrupter]:
    interrupter = Interrupter(line)
    before = sys.gettrace()
    sys.settrace(interrupter)
    try:
        yield interrupter
    except KeyboardInterrupt:
        pass
    finally:
        sys.settrace(before)


def phase_in_force_deg(generator: SignalGenerator) -> float:
    word = generator.status().phase_word_b
    return (word - 4096 if word > 2048 else word) * STEP_DEG


def test_ctrl_c_at_every_line_of_a_command_leaves_the_next_one_sound() -> None:
    generator = connect(InProcessBench())
    generator.set_drive(41_000.0, 0.0)
    for line in range(1, 1000):
        with interrupted(line) as interrupter:
            generator.phase_deg = 45.0 if line % 2 else -45.0
        assert generator.phase_deg == phase_in_force_deg(generator)
        if interrupter.left > 0:
            break
        generator.phase_deg = 90.0
        assert phase_in_force_deg(generator) == 90.0
    assert 40 < line < 900


def test_ctrl_c_at_every_line_of_leaving_still_switches_off() -> None:
    """Where the first line of leaving itself is hit, only the board's watchdog is left."""
    bench = InProcessBench()
    for line in range(2, 1000):
        generator = connect(bench)
        generator.set_drive(41_000.0, 0.0)
        generator.outputs_on = True
        # The port stays open for a look at the board afterwards.
        generator.close = lambda: None  # type: ignore[method-assign]
        with interrupted(line) as interrupter:
            generator.__exit__(None, None, None)
        assert not generator.outputs_on, f"interrupted at line {line}"
        if interrupter.left > 0:
            break
    assert 40 < line < 900
