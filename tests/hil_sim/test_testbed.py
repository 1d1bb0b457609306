"""Board and plant on one simulated time, with a plant that writes down what it is told."""

import time

import numpy as np
import pytest

from hil_sim.board import EFFECT_S, TURN_AROUND_S
from hil_sim.faults import Fault, FaultKind, FaultSchedule
from hil_sim.frame_receiver import build_frame
from hil_sim.line import BYTE_S
from hil_sim.plant import MotorPlant
from hil_sim.sample_feed import SampleFeed
from hil_sim.signals import Drive, Samples
from hil_sim.testbed import HISTORY_LENGTH, Testbed
from usmbench.errors import InputError
from usmbench.instruments.protocol._generated import RequestType

RATE_HZ = 100_000.0
IDENTIFY = build_frame(b"\x01\x01")
SET_DRIVE = build_frame(b"\x02\x02" + (440_000).to_bytes(4, "little") + b"\x00\x04")
ON = build_frame(b"\x03\x04\x01")
HEARTBEAT = build_frame(b"\x04\x06")


class Notebook:
    """A plant whose motor stands still and whose calls are kept."""

    def __init__(self) -> None:
        self.told: list[tuple[str, float, object]] = []
        self.time_s = 0.0
        self.n_sampled = 0

    def tell(self, what: str, time_s: float, value: object) -> None:
        assert time_s >= self.time_s - 1e-12, "the past was changed"
        self.time_s = time_s
        self.told.append((what, time_s, value))

    def drive(self, time_s: float, drive: Drive) -> None:
        self.tell("drive", time_s, drive.amplitude_b)

    def set_load(self, time_s: float, torque_nm: float) -> None:
        self.tell("load", time_s, torque_nm)

    def set_coupling(self, time_s: float, coupled: bool) -> None:
        self.tell("coupling", time_s, coupled)

    def set_dead_channel(self, time_s: float, channel: str | None) -> None:
        self.tell("dead", time_s, channel)

    def sample(self, n_samples: int, sample_rate_hz: float) -> Samples:
        self.n_sampled += n_samples
        zeros = np.zeros(n_samples, dtype=np.int64)
        return Samples(zeros, zeros, 23.0)


def driven(*faults: Fault) -> tuple[Testbed, Notebook]:
    plant = Notebook()
    testbed = Testbed(plant, FaultSchedule(faults))
    testbed.host_bytes(IDENTIFY + SET_DRIVE + ON, 0.0)
    return testbed, plant


REQUESTED_S = len(IDENTIFY + SET_DRIVE + ON) * BYTE_S
SWITCH_ON_S = REQUESTED_S + EFFECT_S[RequestType.OUTPUTS]
CONFIGURED_S = REQUESTED_S - len(ON) * BYTE_S + EFFECT_S[RequestType.SET_DRIVE]


def test_the_effect_comes_after_the_last_byte_and_the_reply_behind_it() -> None:
    testbed, plant = driven()
    replies = testbed.host_bytes(HEARTBEAT, 0.5)
    request_end_s = 0.5 + len(HEARTBEAT) * BYTE_S
    ends_s = [request_end_s + TURN_AROUND_S + n * BYTE_S for n in range(1, len(replies) + 1)]
    assert [reply.time_s for reply in replies] == pytest.approx(ends_s)
    testbed.sample(1000, RATE_HZ)
    assert plant.told[-1][1] == pytest.approx(SWITCH_ON_S)


def test_changes_reach_the_plant_in_order_and_not_before_their_block() -> None:
    testbed, plant = driven(Fault(FaultKind.SLIPPED_COUPLING, 0.0123, duration_s=0.02))
    testbed.sample(100, RATE_HZ)
    assert [what for what, _, _ in plant.told] == []
    testbed.set_load(0.1)
    for _ in range(5):
        testbed.sample(1000, RATE_HZ)
    assert [(what, value) for what, _, value in plant.told] == [
        ("load", 0.1),
        ("drive", 0.0),
        ("drive", 1.0),
        ("coupling", False),
        ("coupling", True),
    ]
    times_s = [0.001, CONFIGURED_S, SWITCH_ON_S, 0.0123, 0.0323]
    assert [time_s for _, time_s, _ in plant.told] == pytest.approx(times_s)


@pytest.mark.parametrize("block", [1, 7, 1000, 100_000])
def test_host_silence_trips_at_one_instant_whatever_the_blocks(block: int) -> None:
    testbed, plant = driven()
    testbed.sample(99_000, RATE_HZ)
    while testbed.time_s < 1.01:
        testbed.sample(block, RATE_HZ)
    trip_s, drive = testbed.drive_history[-1]
    assert trip_s == pytest.approx(REQUESTED_S + 1.0, abs=1e-12)
    assert drive == Drive(440_000 * 25e6 / 2**28, 90.0)
    assert plant.told[-1] == ("drive", trip_s, 0.0)


def test_the_drive_is_off_when_a_vanished_host_is_1_1_s_gone() -> None:
    testbed, _ = driven()
    testbed.idle(0.5)
    testbed.host_bytes(HEARTBEAT, testbed.time_s)
    testbed.idle(1.1)
    time_s, drive = testbed.drive_history[-1]
    assert drive.amplitude_a == 0.0
    assert time_s == pytest.approx(1.5 + len(HEARTBEAT) * BYTE_S)
    assert testbed.time_s == pytest.approx(1.6)


def test_a_reset_strikes_at_its_instant_even_between_two_bytes() -> None:
    testbed, _ = driven(Fault(FaultKind.BOARD_RESET, 0.3 + 2.5 * BYTE_S, cause="brown_out"))
    testbed.idle(0.3)
    assert testbed.host_bytes(HEARTBEAT, 0.3) == []
    reset_s, drive = testbed.drive_history[-1]
    assert (reset_s, drive) == (0.3 + 2.5 * BYTE_S, Drive())
    refusal = testbed.host_bytes(b"\0" + HEARTBEAT, 0.3)
    assert bytes(arrival.byte for arrival in refusal)[2] == 0xC6


def test_a_silent_board_trips_although_the_host_speaks() -> None:
    testbed, _ = driven(Fault(FaultKind.BOARD_SILENT, 0.2))
    answered = []
    for _ in range(13):
        sent_s = testbed.time_s
        if testbed.host_bytes(HEARTBEAT, sent_s):
            answered.append(sent_s)
        testbed.idle(0.1)
    assert answered == pytest.approx([0.0, 0.1])
    off_s, drive = testbed.drive_history[-1]
    assert drive.amplitude_b == 0.0
    assert off_s == pytest.approx(answered[-1] + len(HEARTBEAT) * BYTE_S + 1.0, abs=1e-12)


def test_a_byte_from_the_past_counts_from_now() -> None:
    testbed, _ = driven()
    testbed.idle(0.5)
    assert testbed.host_bytes(HEARTBEAT, 0.1)[0].time_s > 0.5


@pytest.mark.parametrize("torque_nm", [-0.1, float("nan"), float("inf")])
def test_a_load_that_cannot_be_is_refused(torque_nm: float) -> None:
    testbed, plant = driven()
    with pytest.raises(InputError, match="load torque"):
        testbed.set_load(torque_nm)
    testbed.idle(0.1)
    assert all(what == "drive" for what, _, _ in plant.told)


def test_the_history_does_not_grow_for_ever() -> None:
    testbed, _ = driven()
    off = build_frame(b"\x05\x04\x00")
    for _ in range(HISTORY_LENGTH // 2 + 10):
        testbed.host_bytes(off, 0.0)
        testbed.host_bytes(ON, 0.0)
    assert len(testbed.drive_history) == HISTORY_LENGTH


def test_the_same_calls_give_the_same_samples() -> None:
    def positions() -> list[int]:
        testbed = Testbed(MotorPlant(seed=4))
        testbed.host_bytes(IDENTIFY + SET_DRIVE + ON, 0.0)
        return [int(testbed.sample(1000, RATE_HZ).position[-1]) for _ in range(40)]

    first = positions()
    assert first == positions()
    assert first[-1] > 300


class HandClock:
    """Real time as far as the feed can tell, moved by hand."""

    lock_step = False

    def __init__(self) -> None:
        self.time_s = 0.0

    def now_s(self) -> float:
        return self.time_s


def wait_for(feed: SampleFeed, time_s: float) -> None:
    deadline_s = time.monotonic() + 10.0
    while feed.time_s < time_s - 1e-9:
        assert time.monotonic() < deadline_s
        time.sleep(0.001)
    assert feed.time_s == pytest.approx(time_s)


def test_in_real_time_the_testbed_keeps_up_while_nobody_reads() -> None:
    testbed, _ = driven()
    clock = HandClock()
    feed = SampleFeed(testbed, clock)
    try:
        clock.time_s = 0.5
        wait_for(feed, 0.5)
        clock.time_s = 0.7
        feed.start()
        assert feed.time_s == pytest.approx(0.7)
        clock.time_s = 0.9
        time.sleep(0.05)
        assert feed.time_s == pytest.approx(0.7)
        assert len(feed.acquire(1000, RATE_HZ).position) == 1000
        assert feed.time_s == pytest.approx(0.71)
        feed.stop()
        wait_for(feed, 0.9)
    finally:
        feed.close()
