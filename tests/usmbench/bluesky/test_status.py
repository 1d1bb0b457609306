import threading

import pytest
from bluesky.protocols import Status

from usmbench.bluesky.status import DeviceStatus
from usmbench.errors import BenchError


def test_it_is_blueskys_status() -> None:
    assert isinstance(DeviceStatus(), Status)


def test_callbacks_come_once_whenever_they_were_added() -> None:
    status, seen = DeviceStatus(), list[DeviceStatus]()
    status.add_callback(seen.append)
    assert (status.done, status.success, seen) == (False, False, [])
    status.end()
    status.end(BenchError("too late"))
    status.add_callback(seen.append)
    assert (status.done, status.success, seen) == (True, True, [status, status])
    assert status.exception() is None


def test_a_failure_keeps_its_reason_and_shows_it() -> None:
    status = DeviceStatus()
    status.end(BenchError("the port has gone"))
    assert not status.success
    assert "the port has gone" in repr(status)
    with pytest.raises(BenchError, match="the port has gone"):
        status.wait(1.0)


def test_every_wait_has_an_end() -> None:
    status = DeviceStatus()
    with pytest.raises(BenchError, match="not done"):
        status.exception(0.0)
    threading.Timer(0.05, status.end).start()
    status.wait(5.0)
