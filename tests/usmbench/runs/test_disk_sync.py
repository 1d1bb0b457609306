import threading
from pathlib import Path

import pytest

from usmbench.errors import BenchError
from usmbench.runs import disk_sync
from usmbench.runs.disk_sync import DiskSync


class SlowDisk:
    """Takes what is written only when it is let."""

    def __init__(self) -> None:
        self.begun = threading.Semaphore(0)
        self.let = threading.Semaphore(0)
        self.times = 0

    def sync(self) -> None:
        self.begun.release()
        assert self.let.acquire(timeout=10.0)
        self.times += 1


def test_requests_made_while_the_disk_is_at_work_are_served_at_one_go(tmp_path: Path) -> None:
    disk = SlowDisk()
    syncing = DiskSync(disk.sync, tmp_path)
    syncing.request()
    assert disk.begun.acquire(timeout=10.0)
    for _ in range(5):
        syncing.request()
    for _ in range(3):
        disk.let.release()
    syncing.finish()
    # What was written after the first had begun takes a second; `finish` may find it under way.
    assert disk.times in (2, 3)


def test_a_failure_is_told_of_at_the_next_check(tmp_path: Path) -> None:
    failed = threading.Event()

    def fail() -> None:
        failed.set()
        raise BenchError("broken")

    syncing = DiskSync(fail, tmp_path)
    syncing.check()
    syncing.request()
    assert failed.wait(10.0)
    with pytest.raises(BenchError, match="broken"):
        syncing.finish()
    with pytest.raises(BenchError, match="broken"):
        syncing.check()


def test_a_disk_that_stands_still_is_not_waited_for_without_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(disk_sync, "SYNC_TIMEOUT_S", 0.05)
    disk = SlowDisk()
    syncing = DiskSync(disk.sync, tmp_path)
    with pytest.raises(BenchError, match=r"not been ready.*last second may be lost.*--resume"):
        syncing.finish()
    disk.let.release()
