"""The board's pseudo-terminal: pace, hang-ups, and the port that goes."""

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import serial

from hil_sim.clock import LockStep, RealTime
from hil_sim.faults import Fault, FaultKind, FaultSchedule
from hil_sim.frame_receiver import build_frame
from hil_sim.line import BYTE_S
from hil_sim.plant import MotorPlant
from hil_sim.pty_edge import PtyEdge
from hil_sim.testbed import Testbed

HEARTBEAT = build_frame(b"\x04\x06")
REPLY_SIZE = 8  # a refusal: nobody has asked the board who it is
WIRE_S = (len(HEARTBEAT) + REPLY_SIZE) * BYTE_S


@contextmanager
def edge(*faults: Fault, lock_step: bool = False) -> Iterator[tuple[PtyEdge, Testbed]]:
    testbed = Testbed(MotorPlant(), FaultSchedule(faults))
    port = PtyEdge(testbed, LockStep(testbed) if lock_step else RealTime())
    try:
        yield port, testbed
    finally:
        port.stop()
        port.stop()


def exchange(port: serial.Serial) -> bytes:
    port.write(HEARTBEAT)
    return bytes(port.read(REPLY_SIZE))


def test_a_round_trip_is_never_faster_than_the_wire_and_mostly_little_slower() -> None:
    with edge() as (pty, _), serial.Serial(pty.path, 115200, timeout=1.0) as port:
        trips_s = []
        for _ in range(60):
            begun_s = time.monotonic()
            assert len(exchange(port)) == REPLY_SIZE
            trips_s.append(time.monotonic() - begun_s)
            time.sleep(0.001)
        assert min(trips_s) >= WIRE_S
        # The best tenth: a busy machine delays some, a pace that is wrong delays all.
        assert sorted(trips_s)[6] < 1.3 * WIRE_S


def test_lock_step_answers_without_time_passing() -> None:
    with (
        edge(lock_step=True) as (pty, testbed),
        serial.Serial(pty.path, 115200, timeout=5.0) as port,
    ):
        replies = {exchange(port) for _ in range(50)}
        assert len(replies) == 1
        assert testbed.time_s == 0.0


@pytest.mark.parametrize("lock_step", [False, True])
def test_a_late_byte_is_late_on_the_wall_clock(lock_step: bool) -> None:
    late = Fault(FaultKind.LATE_BYTE, 0.0, direction="to_host", delay_s=0.1)
    with (
        edge(late, lock_step=lock_step) as (pty, _),
        serial.Serial(pty.path, 115200, timeout=5.0) as port,
    ):
        begun_s = time.monotonic()
        assert len(exchange(port)) == REPLY_SIZE
        assert time.monotonic() - begun_s > 0.1


def test_hosts_come_and_go() -> None:
    with edge() as (pty, _):
        for _ in range(20):
            with serial.Serial(pty.path, 115200, timeout=5.0) as port:
                assert len(exchange(port)) == REPLY_SIZE
        with serial.Serial(pty.path, 115200) as port:
            port.write(HEARTBEAT)
        time.sleep(0.02)
        with serial.Serial(pty.path, 115200, timeout=5.0) as port:
            port.reset_input_buffer()
            assert len(exchange(port)) == REPLY_SIZE


def test_a_host_that_never_reads_does_not_stop_the_board() -> None:
    with edge(lock_step=True) as (pty, _), serial.Serial(pty.path, 115200, timeout=5.0) as port:
        for _ in range(40):
            port.write(HEARTBEAT * 50)
            time.sleep(0.002)
        deadline_s = time.monotonic() + 5.0
        while time.monotonic() < deadline_s:
            port.reset_input_buffer()
            if len(exchange(port)) == REPLY_SIZE:
                break
        assert time.monotonic() < deadline_s


def test_the_port_that_goes_takes_its_device_with_it() -> None:
    with (
        edge(Fault(FaultKind.PORT_GONE, 1.0)) as (pty, _),
        serial.Serial(pty.path, 115200, timeout=2.0) as port,
    ):
        time.sleep(1.1)
        with pytest.raises(OSError):
            exchange(port)
    assert not Path(pty.path).exists()


def test_stopping_leaves_no_descriptor_behind() -> None:
    before = len(os.listdir("/proc/self/fd"))  # noqa: PTH208 - there is no other way to count them
    for _ in range(5):
        with edge():
            pass
    assert len(os.listdir("/proc/self/fd")) == before  # noqa: PTH208
