from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import bluesky.plan_stubs as bps
import bluesky.preprocessors
import bluesky.suspenders
import pytest
from bluesky.plans import count, scan
from bluesky.protocols import (
    Checkable,
    Configurable,
    Flyable,
    Locatable,
    Movable,
    Pausable,
    Readable,
    Stoppable,
    Subscribable,
    Triggerable,
)
from bluesky.utils import FailedStatus

from hil_sim.faults import Fault, FaultKind
from usmbench.errors import BenchError, DaqError, InputError, PortError

SUSPENDERS: Any = bluesky.suspenders
PREPROCESSORS: Any = bluesky.preprocessors


def test_the_devices_have_blueskys_protocols(open_bench: Any) -> None:
    with open_bench() as bench:
        devices = bench.devices
        for device in (devices.phase, devices.frequency):
            for protocol in (Movable, Readable, Locatable, Stoppable, Checkable, Configurable):
                assert isinstance(device, protocol), protocol
        assert isinstance(devices.encoder, Readable)
        assert isinstance(devices.encoder, Triggerable)
        assert isinstance(devices.encoder, Configurable)
        assert isinstance(devices.encoder, Pausable)
        assert isinstance(devices.windows, Flyable)
        for signal in (devices.ready, devices.speed, devices.temperature):
            assert isinstance(signal, Readable)
            assert isinstance(signal, Subscribable)


def test_a_scan_gives_the_curve_and_leaves_the_drive_off(open_bench: Any) -> None:
    with open_bench() as bench:
        devices = bench.devices
        bench.engine(scan([devices.encoder, devices.frequency], devices.phase, -90, 90, 37))
        assert not bench.drive_is_on
        events = bench.events()
        assert [event["phase_deg"] for event in events] == [-90.0 + 5.0 * k for k in range(37)]
        # The paper's motor runs at about 10.25 rad/s at full phase, the other way at the other end.
        assert events[-1]["speed_rad_s"] == pytest.approx(10.25, rel=0.05)
        assert events[0]["speed_rad_s"] == pytest.approx(-10.25, rel=0.05)
        speeds = [event["speed_rad_s"] for event in events]
        assert all(b > a - 0.1 for a, b in pairwise(speeds))
        assert {event["settled"] for event in events} == {1}
        assert {event["frequency_hz"] for event in events} == {41_000.0}
        descriptor = bench.last("descriptor")
        assert descriptor["data_keys"]["speed_rad_s"]["units"] == "rad/s"
        assert descriptor["data_keys"]["phase_deg"]["limits"]["control"]["high"] == 180.0
        assert descriptor["configuration"]["encoder"]["data"]["counts_per_rev"] == 2000
        assert bench.last("start")["hints"]["dimensions"] == [(["phase_deg"], "primary")]
        assert bench.last("stop")["exit_status"] == "success"


def test_frequency_is_another_axis(open_bench: Any) -> None:
    with open_bench() as bench:
        devices = bench.devices

        def plan() -> Iterator[Any]:
            yield from bps.mv(devices.frequency, 40_800.0, devices.phase, 60.0)
            yield from bps.trigger_and_read([devices.encoder, devices.frequency])
            yield from bps.mv(devices.frequency, 41_500.0)
            yield from bps.trigger_and_read([devices.encoder, devices.frequency])

        bench.engine(PREPROCESSORS.run_wrapper(plan()))
        events = bench.events()
        assert [event["frequency_hz"] for event in events] == [40_800.0, 41_500.0]
        assert events[0]["speed_rad_s"] > events[1]["speed_rad_s"] > 0.0
        assert not bench.drive_is_on


def test_a_plan_that_fails_leaves_the_drive_off(open_bench: Any) -> None:
    with open_bench() as bench:

        def plan() -> Iterator[Any]:
            yield from bps.mv(bench.devices.phase, 90.0)
            assert bench.drive_is_on
            raise ZeroDivisionError

        with pytest.raises(ZeroDivisionError):
            bench.engine(plan())
        assert not bench.drive_is_on


@pytest.mark.parametrize("device", ["phase", "frequency"])
def test_a_setpoint_beyond_the_limits_is_refused_before_anything_is_sent(
    open_bench: Any, device: str
) -> None:
    with open_bench() as bench:
        with pytest.raises(InputError, match="outside"):
            bench.engine(bps.mv(getattr(bench.devices, device), 50_000.0))
        with pytest.raises(InputError, match="outside"):
            getattr(bench.devices, device).check_value(50_000.0)
        assert not bench.simulated.testbed.drive_history


def test_the_encoder_is_not_read_untriggered(open_bench: Any) -> None:
    with open_bench() as bench, pytest.raises(BenchError, match="trigger"):
        bench.devices.encoder.read()


def test_every_window_flies_along(open_bench: Any) -> None:
    with open_bench() as bench:
        devices = bench.devices
        plan = scan([devices.encoder], devices.phase, 0, 90, 3)
        bench.engine(PREPROCESSORS.fly_during_wrapper(plan, [devices.windows]))
        windows = bench.events("windows")
        t_s = [window["t_s"] for window in windows]
        assert len(t_s) > 30
        steps = [b - a for a, b in pairwise(t_s)]
        assert steps == pytest.approx([0.01] * len(steps))
        assert {window["phase_deg"] for window in windows} >= {0.0, 45.0, 90.0}


def test_windows_fly_once_after_a_plan_that_was_aborted(open_bench: Any) -> None:
    with open_bench() as bench:
        devices = bench.devices

        def aborted() -> Iterator[Any]:
            yield from bps.kickoff(devices.windows, wait=True)
            yield from bps.trigger_and_read([devices.encoder])
            raise ZeroDivisionError

        with pytest.raises(ZeroDivisionError):
            bench.engine(PREPROCESSORS.run_wrapper(aborted()))
        bench.documents.clear()
        plan = scan([devices.encoder], devices.phase, 0, 90, 3)
        bench.engine(PREPROCESSORS.fly_during_wrapper(plan, [devices.windows]))
        t_s = [window["t_s"] for window in bench.events("windows")]
        assert len(t_s) > 30
        assert t_s == sorted(set(t_s))
        assert not devices.loop.listeners


def test_the_speed_is_monitored(open_bench: Any) -> None:
    with open_bench() as bench:
        devices = bench.devices
        plan = scan([devices.encoder], devices.phase, 45, 90, 2)
        bench.engine(PREPROCESSORS.monitor_during_wrapper(plan, [devices.speed]))
        seen = bench.events("live_speed_rad_s_monitor")
        assert len(seen) > 20
        assert max(event["live_speed_rad_s"] for event in seen) > 9.0
        assert not devices.speed._callbacks


def test_a_measurement_that_is_stopped_ends_without_a_speed(open_bench: Any) -> None:
    with open_bench() as bench:
        devices = bench.devices
        devices.phase.set(60.0).wait(10.0)
        first, second = devices.encoder.trigger(), devices.encoder.trigger()
        devices.phase.stop()
        first.wait(10.0)
        second.wait(10.0)
        with pytest.raises(BenchError, match="no speed was measured"):
            devices.encoder.read()


@pytest.mark.parametrize("kind", [FaultKind.EVENT_STREAM_DEAD, FaultKind.DAQ_OVERFLOW])
def test_a_card_that_breaks_ends_the_plan_with_its_reason(open_bench: Any, kind: FaultKind) -> None:
    with open_bench((Fault(kind, 3.0),)) as bench:
        plan = scan([bench.devices.encoder], bench.devices.phase, -90, 90, 1000)
        with pytest.raises(FailedStatus) as failed:
            bench.engine(plan)
        assert isinstance(failed.value.__cause__, DaqError)
        assert not bench.drive_is_on
        with pytest.raises(FailedStatus):
            bench.engine(bps.mv(bench.devices.phase, 10.0))


def test_a_port_that_goes_ends_the_plan_and_is_told_again_at_the_end(open_bench: Any) -> None:
    said: list[BaseException | None] = []

    def scan_on() -> None:
        with open_bench((Fault(FaultKind.PORT_GONE, 3.0),)) as bench:
            plan = scan([bench.devices.encoder], bench.devices.phase, -90, 90, 1000)
            with pytest.raises(FailedStatus) as failed:
                bench.engine(plan)
            said.append(failed.value.__cause__)

    # Nobody knows then whether the drive is off: it must not end in silence.
    with pytest.raises(PortError, match="gone"):
        scan_on()
    assert isinstance(said[0], PortError)


def test_a_count_without_drive_stands_still(open_bench: Any) -> None:
    with open_bench() as bench:
        bench.engine(count([bench.devices.encoder], 3))
        assert [event["speed_rad_s"] for event in bench.events()] == [0.0, 0.0, 0.0]
        assert not bench.simulated.testbed.drive_history
