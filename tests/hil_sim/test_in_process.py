"""The testbed behind the sweep's two protocols, without edges."""

import errno
from typing import Any

import numpy as np
import pytest

from hil_sim.faults import Direction, Fault, FaultKind
from hil_sim.frame_receiver import build_frame
from hil_sim.in_process import OVERFLOW_CODE, InProcessBench
from usmbench.errors import DaqError, NoDataError
from usmbench.instruments.serial_port import SerialPort

IDENTIFY = build_frame(b"\x01\x01")
SET_DRIVE = build_frame(b"\x02\x02" + (440_000).to_bytes(4, "little") + b"\x00\x04")
ON = build_frame(b"\x03\x04\x01")
HEARTBEAT = build_frame(b"\x04\x06")
SHORT_REPLY = 7


def running(*faults: Fault, **settings: Any) -> InProcessBench:
    bench = InProcessBench(2, faults=faults, **settings)
    bench.port.write(IDENTIFY + SET_DRIVE + ON)
    bench.port.read(bench.port.in_waiting)
    bench.port.timeout = 0.1
    bench.source.start()
    return bench


def counts(bench: InProcessBench, n_blocks: int) -> np.ndarray:
    return np.concatenate([bench.source.next_block().counts for _ in range(n_blocks)])


def exchange(port: SerialPort) -> bytes:
    port.write(HEARTBEAT)
    return port.read(SHORT_REPLY)


def test_blocks_follow_each_other_and_move_time() -> None:
    bench = running()
    blocks = [bench.source.next_block() for _ in range(30)]
    assert [block.first_sample for block in blocks] == list(range(0, 30_000, 1000))
    assert bench.clock() == pytest.approx(0.3)
    assert bench.source.samples_acquired() == 30_000
    assert blocks[-1].counts[-1] > 500
    index_counts = [block.index_counts for block in blocks if block.index_counts is not None]
    assert [len(counts) for counts in index_counts] == 3 * [*9 * [0], 10_000]
    assert index_counts[-1][-1] >= 1
    assert blocks[-1].temperature_c is None


def test_a_reply_is_there_at_once_and_takes_no_time() -> None:
    bench = running()
    assert len(exchange(bench.port)) == SHORT_REPLY
    assert bench.clock() == 0.0
    bench.port.write(HEARTBEAT)
    assert bench.port.in_waiting == SHORT_REPLY


def test_waiting_for_nothing_lets_time_pass_and_keeps_its_samples() -> None:
    waited, straight = running(), running()
    waited.port.timeout = 0.0123
    assert waited.port.read(1) == b""
    assert waited.clock() == pytest.approx(0.0123)
    assert waited.source.samples_acquired() == 1230
    assert np.array_equal(counts(waited, 5), counts(straight, 5))
    assert waited.clock() == pytest.approx(0.05)


def test_samples_before_the_start_are_not_counted() -> None:
    bench = InProcessBench(2)
    bench.port.timeout = 0.05
    assert bench.port.read(1) == b""
    bench.source.start()
    assert bench.source.samples_acquired() == 0
    assert bench.source.next_block().first_sample == 0
    assert bench.clock() == pytest.approx(0.06)


def test_a_late_byte_is_waited_for() -> None:
    bench = running(Fault(FaultKind.LATE_BYTE, 0.05, direction="to_host", delay_s=0.03))
    counts(bench, 10)
    assert len(exchange(bench.port)) == SHORT_REPLY
    assert 0.13 < bench.clock() < 0.135


def test_a_byte_later_than_the_time_out_comes_with_the_next_read() -> None:
    bench = running(Fault(FaultKind.LATE_BYTE, 0.05, direction="to_board", delay_s=0.15))
    counts(bench, 10)
    assert exchange(bench.port) == b""
    assert bench.clock() == pytest.approx(0.2)
    assert len(bench.port.read(SHORT_REPLY)) == SHORT_REPLY


@pytest.mark.parametrize("kind", [FaultKind.LOST_BYTE, FaultKind.FLIPPED_BYTE])
@pytest.mark.parametrize("direction", ["to_board", "to_host"])
def test_a_spoilt_frame_costs_one_resend(kind: FaultKind, direction: Direction) -> None:
    bench = running(Fault(kind, 0.05, direction=direction))
    counts(bench, 10)
    good = exchange(running().port)
    assert exchange(bench.port) != good
    bench.port.write(b"\0")
    bench.port.read(bench.port.in_waiting)
    assert exchange(bench.port) == good


def test_the_port_goes_at_its_instant() -> None:
    bench = running(Fault(FaultKind.PORT_GONE, 0.12))
    counts(bench, 12)
    for operation in (
        lambda: bench.port.read(1),
        lambda: bench.port.write(HEARTBEAT),
        lambda: bench.port.in_waiting,
    ):
        with pytest.raises(OSError, match="gone") as gone:
            operation()
        assert gone.value.errno == errno.EIO
    bench.testbed.idle(1.1)
    assert bench.testbed.drive_history[-1][1].amplitude_a == 0.0


def test_a_read_ends_when_the_port_goes_under_it() -> None:
    bench = running(Fault(FaultKind.PORT_GONE, 0.05))
    with pytest.raises(OSError, match="gone"):
        bench.port.read(1)


def test_a_closed_port_says_so() -> None:
    bench = running()
    bench.port.close()
    with pytest.raises(OSError, match="closed"):
        bench.port.read(1)


def test_overflow_and_dead_server_come_with_the_block_they_spoil() -> None:
    bench = running(Fault(FaultKind.DAQ_OVERFLOW, 0.095))
    counts(bench, 9)
    with pytest.raises(DaqError) as overflow:
        bench.source.next_block()
    assert overflow.value.code == OVERFLOW_CODE == -200279
    dead = running(Fault(FaultKind.SERVER_DEAD, 0.0))
    with pytest.raises(DaqError, match="server does not answer"):
        dead.source.next_block()


def test_a_dead_event_stream_is_silence_for_the_time_out() -> None:
    bench = running(Fault(FaultKind.EVENT_STREAM_DEAD, 0.095), no_data_timeout_s=0.3)
    counts(bench, 9)
    with pytest.raises(NoDataError, match=r"0\.3 s"):
        bench.source.next_block()
    assert bench.clock() == pytest.approx(0.4)


def test_a_wrapping_counter_loses_nothing() -> None:
    wrapping = running(Fault(FaultKind.COUNTER_WRAP, 0.0, counts=50))
    bits = wrapping.source.counter_bits
    read = counts(wrapping, 30)
    assert read[0] == (1 << bits) - 50
    assert read[-1] < 1 << 20
    assert np.array_equal((read + 50) % (1 << bits), counts(running(), 30))


def test_e_series_counts_lines() -> None:
    lines = running(family="e_series")
    assert lines.source.counter_bits == 24
    assert np.array_equal(counts(lines, 20), counts(running(), 20) // 4)


def test_a_slipped_coupling_and_a_dead_channel_stop_the_count() -> None:
    for kind in (FaultKind.SLIPPED_COUPLING, FaultKind.DEAD_CHANNEL):
        bench = running(Fault(kind, 0.15))
        counts(bench, 15)
        read = counts(bench, 15)
        assert read.max() - read.min() <= 1
        assert bench.testbed.drive_history[-1][1].amplitude_a == 1.0


def test_the_temperature_is_what_an_analogue_input_would_read() -> None:
    temperature_c = running(temperature=True).source.next_block().temperature_c
    assert temperature_c is not None
    assert temperature_c / 100 * 2**16 == round(temperature_c / 100 * 2**16)
    assert 15 < temperature_c < 35


def test_the_load_acts() -> None:
    free, braked = running(), running()
    braked.set_load(0.2)
    assert counts(braked, 30)[-1] < 0.98 * counts(free, 30)[-1]


def test_one_seed_gives_one_train_of_counts() -> None:
    assert np.array_equal(counts(running(), 50), counts(running(), 50))
    other = InProcessBench(3)
    other.port.write(IDENTIFY + SET_DRIVE + ON)
    other.source.start()
    assert not np.array_equal(counts(running(), 50), counts(other, 50))
