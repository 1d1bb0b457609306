"""Interlocks that trip while bluesky drives, suspenders that wait, and acknowledgements."""

import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import bluesky.plan_stubs as bps
import bluesky.preprocessors
import bluesky.suspenders
import pytest
from bluesky.plans import scan
from bluesky.utils import FailedStatus

from usmbench.errors import InterlockError
from usmbench.sweep.window_reader import WindowReader

SUSPENDERS: Any = bluesky.suspenders
PREPROCESSORS: Any = bluesky.preprocessors


def wait_for(true: Callable[[], object]) -> None:
    deadline_s = time.monotonic() + 20.0
    while not true():
        assert time.monotonic() < deadline_s, "waited in vain"
        time.sleep(0.01)


def test_an_interlock_fails_a_plan_that_has_no_suspender(open_bench: Any) -> None:
    with open_bench(overspeed_rad_s=5.0) as bench:
        devices = bench.devices
        with pytest.raises(FailedStatus) as failed:
            bench.engine(scan([devices.encoder], devices.phase, 0, 90, 7))
        assert isinstance(failed.value.__cause__, InterlockError)
        assert not bench.drive_is_on
        assert devices.ready.get() is False
        # Nothing moves again before somebody has looked at the bench.
        with pytest.raises(FailedStatus):
            bench.engine(bps.mv(devices.phase, 10.0))
        assert not bench.drive_is_on
        devices.acknowledge()
        wait_for(devices.ready.get)
        bench.engine(scan([devices.encoder], devices.phase, 0, 10, 2))


def test_an_interlock_leaves_what_a_speed_was_measured_at(open_bench: Any) -> None:
    with open_bench(overspeed_rad_s=5.0) as bench:
        devices = bench.devices
        devices.phase.set(90.0).wait(10.0)
        wait_for(lambda: devices.ready.get() is False)
        wait_for(lambda: not bench.drive_is_on)
        assert devices.phase.read()["phase_deg"]["value"] == 90.0
        devices.phase.stop()
        assert devices.phase.read()["phase_deg"]["value"] == 0.0


def test_a_suspender_waits_until_the_interlock_is_acknowledged(
    open_bench: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    """A load stalls the motor: the drive goes off; the load is taken away, the scan goes on."""
    with open_bench() as bench:
        devices = bench.devices
        bench.engine.install_suspender(SUSPENDERS.SuspendBoolLow(devices.ready))
        seen_off: list[bool] = []

        def look_after_it() -> None:
            wait_for(lambda: len(bench.events()) >= 2)
            bench.simulated.set_load(5.0)
            wait_for(lambda: devices.ready.get() is False)
            wait_for(lambda: bench.engine.state == "suspending" or not bench.drive_is_on)
            time.sleep(1.0)
            seen_off.append(not bench.drive_is_on)
            bench.simulated.set_load(0.0)
            devices.acknowledge()

        helper = threading.Thread(target=look_after_it)
        helper.start()
        bench.engine(scan([devices.encoder], devices.phase, 86, 90, 9))
        helper.join(30.0)
        assert seen_off == [True]
        events = bench.events()
        assert [event["phase_deg"] for event in events] == [86 + 0.5 * k for k in range(9)]
        assert all(event["speed_rad_s"] > 9.0 for event in events[-3:])
        assert bench.last("stop")["exit_status"] == "success"
        assert not bench.drive_is_on
    assert "Suspending" in capsys.readouterr().out


def test_a_suspender_on_a_signal_switches_off_and_begins_the_point_again(
    open_bench: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    with open_bench() as bench:
        devices = bench.devices
        bench.engine.install_suspender(
            SUSPENDERS.SuspendCeil(devices.temperature, 60.0, resume_thresh=50.0)
        )

        def warm_and_cool() -> None:
            wait_for(lambda: len(bench.events()) >= 2)
            devices.temperature.put(65.0, time.time())
            wait_for(lambda: not bench.drive_is_on)
            devices.temperature.put(45.0, time.time())

        helper = threading.Thread(target=warm_and_cool)
        helper.start()
        bench.engine(scan([devices.encoder], devices.phase, 30, 90, 31))
        helper.join(30.0)
        assert [event["phase_deg"] for event in bench.events()] == [30 + 2 * k for k in range(31)]
        assert all(event["speed_rad_s"] > 3.0 for event in bench.events())
    assert "Suspending" in capsys.readouterr().out


def test_a_point_suspended_before_its_wait_is_begun_again(open_bench: Any) -> None:
    """bluesky waits for what a point began before the suspension and after it, together."""
    with open_bench() as bench:
        devices = bench.devices
        bench.engine.install_suspender(
            SUSPENDERS.SuspendCeil(devices.temperature, 60.0, resume_thresh=50.0)
        )
        begun: list[float] = []

        def point() -> Iterator[Any]:
            yield from bps.checkpoint()
            yield from bps.mv(devices.phase, 60.0)
            yield from bps.trigger(devices.encoder, group="speed")
            begun.append(time.monotonic())
            yield from bps.sleep(0.5)
            yield from bps.wait(group="speed", timeout=20.0)
            yield from bps.create()
            yield from bps.read(devices.encoder)
            yield from bps.save()

        def warm_and_cool() -> None:
            wait_for(lambda: begun)
            devices.temperature.put(65.0, time.time())
            wait_for(lambda: not bench.drive_is_on)
            devices.temperature.put(45.0, time.time())

        helper = threading.Thread(target=warm_and_cool)
        helper.start()
        bench.engine(PREPROCESSORS.run_wrapper(point()))
        helper.join(30.0)
        assert [event["speed_rad_s"] > 3.0 for event in bench.events()] == [True]


def test_what_an_interlock_ended_fails_though_it_is_acknowledged_at_once(open_bench: Any) -> None:
    with open_bench(overspeed_rad_s=5.0) as bench:
        devices = bench.devices
        devices.phase.set(90.0)
        ended = devices.encoder.trigger()
        wait_for(lambda: devices.ready.get() is False)
        devices.acknowledge()
        with pytest.raises(InterlockError, match="over-speed"):
            ended.wait(10.0)


def test_what_is_asked_for_before_the_acknowledgement_fails(open_bench: Any) -> None:
    with open_bench(overspeed_rad_s=5.0) as bench:
        devices = bench.devices
        devices.phase.set(90.0)
        wait_for(lambda: devices.ready.get() is False)
        early = devices.encoder.trigger()
        devices.acknowledge()
        with pytest.raises(InterlockError, match="over-speed"):
            early.wait(10.0)
        devices.encoder.trigger().wait(10.0)


def test_one_that_trips_meanwhile_is_not_acknowledged(
    open_bench: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    watch = WindowReader.watch
    with open_bench(overspeed_rad_s=5.0) as bench:
        devices = bench.devices

        def acknowledge_first(reader: WindowReader, *, hands_off: bool) -> None:
            if devices.ready.get():
                devices.acknowledge()
            watch(reader, hands_off=hands_off)

        monkeypatch.setattr(WindowReader, "watch", acknowledge_first)
        devices.phase.set(90.0).wait(10.0)
        wait_for(lambda: devices.ready.get() is False)
        with pytest.raises(InterlockError, match="over-speed"):
            devices.phase.set(10.0).wait(10.0)
        assert devices.ready.get() is False
