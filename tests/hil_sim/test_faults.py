"""Schedules of faults, and the texts they are read from."""

import math
import os
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_sim.fault_entries import parse_fault, random_fault, read_faults
from hil_sim.faults import Fault, FaultKind, FaultSchedule
from usmbench.errors import InputError
from usmbench.instruments.protocol._generated import ResetCause


def test_a_schedule_is_in_the_order_of_its_instants() -> None:
    late, early = Fault(FaultKind.PORT_GONE, 2.0), Fault(FaultKind.LOST_BYTE, 1.0)
    assert FaultSchedule([late, early]).faults == (early, late)
    assert FaultSchedule([late, early]).of(FaultKind.PORT_GONE, FaultKind.DAQ_OVERFLOW) == (late,)


def test_a_lasting_fault_is_active_from_its_instant_to_its_end() -> None:
    slip = Fault(FaultKind.SLIPPED_COUPLING, 1.0, duration_s=0.5)
    again = Fault(FaultKind.SLIPPED_COUPLING, 2.0)
    schedule = FaultSchedule([slip, again])
    active = [schedule.active(FaultKind.SLIPPED_COUPLING, t) for t in (0.9, 1.0, 1.4, 1.5, 9e9)]
    assert active == [None, slip, slip, None, again]
    assert schedule.active(FaultKind.PORT_GONE, 9.0) is None


def test_faults_on_the_command_line() -> None:
    assert parse_fault("port_gone@1e-1") == Fault(FaultKind.PORT_GONE, 0.1)
    assert parse_fault("late_byte@3,direction=to_host,delay_s=0.05") == Fault(
        FaultKind.LATE_BYTE, 3, direction="to_host", delay_s=0.05
    )
    reset = parse_fault("board_reset@2,cause=brown_out")
    assert reset.reset_cause is ResetCause.BROWN_OUT
    assert parse_fault("dead_channel@2,channel=a").end_s == math.inf


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("port_gone", "time_s must be a number"),
        ("port_gone@", "time_s must be a number"),
        ("port_gone@soon", "time_s must be a number"),
        ("port_gone@nan", "time_s must be 0 or later"),
        ("port_gone@-1", "time_s must be 0 or later"),
        ("port_away@1", "there are flipped_byte, lost_byte"),
        ("port_gone@1,bit=3", "no option bit"),
        ("port_gone@1,colour=3", "options of its kind"),
        ("port_gone@1,bit", "not name=value"),
        ("flipped_byte@1,bit=8", "bit must be 0 to 7"),
        ("flipped_byte@1,bit=high", "bit must be a number"),
        ("lost_byte@1,direction=up", "to_board, to_host or both"),
        ("late_byte@1,delay_s=0", "delay_s must be positive"),
        ("board_reset@1,cause=anger", "is one of power_on"),
        ("counter_wrap@1", "its time is 0"),
        ("counter_wrap@0,counts=0", "counts must be positive"),
        ("counter_wrap@0,counts=1.5", "counts must be a whole number, not 1.5"),
        ("flipped_byte@1,bit=3.0", "bit must be a whole number, not 3.0"),
        ("dead_channel@1,channel=c", "channel is a or b"),
        ("slipped_coupling@1,duration_s=0", "duration_s must be positive"),
    ],
)
def test_what_is_no_fault_is_refused_by_name(text: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        parse_fault(text)


@settings(deadline=None)
@given(st.text())
def test_any_text_is_a_fault_or_an_input_error(text: str) -> None:
    for entry in (text, f"lost_byte@{text}", f"lost_byte@1,direction={text}"):
        with suppress(InputError):
            assert isinstance(parse_fault(entry), Fault)


def test_a_file_of_faults(tmp_path: Path) -> None:
    file = tmp_path / "faults.yaml"
    file.write_text("- {kind: daq_overflow, time_s: 1.5}\n- {kind: counter_wrap, time_s: 0}\n")
    assert [fault.kind for fault in read_faults(file)] == ["daq_overflow", "counter_wrap"]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("a: [", "faults.yaml:1|faults.yaml:2"),
        ("kind: port_gone", "expected a list"),
        ("- port_gone", "entry 1"),
        ("- {kind: port_gone, time_s: 1}\n- {kind: port_gone, time_s: true}", "entry 2: time_s"),
        ("- {kind: [1], time_s: 1}", "no such kind"),
        ("- {kind: port_gone, time_s: 2026-99-99}", "entry 1: time_s must be a number"),
    ],
)
def test_a_wrong_file_is_refused_with_the_place(tmp_path: Path, text: str, says: str) -> None:
    file = tmp_path / "faults.yaml"
    file.write_text(text)
    with pytest.raises(InputError, match=says) as refused:
        read_faults(file)
    assert str(refused.value).count("faults.yaml") == 1


def test_a_missing_file_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_faults(tmp_path / "none.yaml")


def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "faults.yaml")
    with pytest.raises(InputError, match=r"faults\.yaml: is a pipe or a device"):
        read_faults(tmp_path / "faults.yaml")


def test_chance_draws_every_kind_within_the_time() -> None:
    rng = np.random.default_rng(5)
    drawn = [random_fault(rng, 3.0) for _ in range(400)]
    assert {fault.kind for fault in drawn} == set(FaultKind)
    assert all(0.0 <= fault.time_s < 3.0 for fault in drawn)
    again = np.random.default_rng(5)
    assert drawn[:20] == [random_fault(again, 3.0) for _ in range(20)]
