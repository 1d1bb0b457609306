"""Bytes on the line, on time and not."""

import pytest

from hil_sim.faults import Fault, FaultKind, FaultSchedule
from hil_sim.line import BYTE_S, Line

DATA = b"\x10\x20\x30"


def sent(*faults: Fault, at_s: float = 1.0, direction: str = "to_board") -> list[tuple[float, int]]:
    line = Line(direction, FaultSchedule(faults))
    return [((a.time_s - at_s) / BYTE_S, a.byte) for a in line.send(DATA, at_s)]


def approx(*arrivals: tuple[float, int]) -> object:
    return [(pytest.approx(time_s, abs=1e-6), byte) for time_s, byte in arrivals]


def test_bytes_take_their_time_and_queue() -> None:
    line = Line("to_board", FaultSchedule())
    line.send(DATA, 1.0)
    later = line.send(DATA, 1.0 + BYTE_S)
    assert [a.time_s for a in later] == pytest.approx([1.0 + n * BYTE_S for n in (4, 5, 6)])
    assert not any(a.late for a in later)


def test_a_flipped_bit() -> None:
    fault = Fault(FaultKind.FLIPPED_BYTE, 1.0 + 1.5 * BYTE_S, bit=3)
    assert sent(fault) == approx((1, 0x10), (2, 0x28), (3, 0x30))


def test_a_lost_byte_still_takes_its_time() -> None:
    assert sent(Fault(FaultKind.LOST_BYTE, 0.5)) == approx((2, 0x20), (3, 0x30))


def test_a_doubled_byte_pushes_those_behind_it() -> None:
    doubled = Fault(FaultKind.DOUBLED_BYTE, 0.5)
    assert sent(doubled) == approx((1, 0x10), (2, 0x10), (3, 0x20), (4, 0x30))


def test_a_late_byte_holds_up_those_behind_it() -> None:
    line = Line("to_host", FaultSchedule([Fault(FaultKind.LATE_BYTE, 1.0 + 1.5 * BYTE_S)]))
    arrivals = line.send(DATA, 1.0)
    assert [a.late for a in arrivals] == [False, True, True]
    assert arrivals[1].time_s == pytest.approx(1.0 + 2 * BYTE_S + 0.02)
    assert arrivals[2].time_s == pytest.approx(1.0 + 3 * BYTE_S + 0.02)
    assert not line.send(DATA, 2.0)[0].late


def test_silence_drops_bytes_until_it_is_over() -> None:
    silent = Fault(FaultKind.BOARD_SILENT, 1.0 + 1.5 * BYTE_S, duration_s=BYTE_S)
    assert sent(silent) == approx((1, 0x10), (3, 0x30))


def test_a_fault_hits_once_and_only_its_direction() -> None:
    lost = Fault(FaultKind.LOST_BYTE, 0.0, direction="to_host")
    assert len(sent(lost)) == len(DATA)
    line = Line("to_host", FaultSchedule([lost]))
    assert [len(line.send(DATA, 1.0)) for _ in range(2)] == [2, 3]
