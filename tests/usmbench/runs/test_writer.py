"""The run folder while it is written: whole at every instant, whatever is done to the process."""

import errno
import os
import random
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import yaml

from usmbench.errors import BenchError, InputError
from usmbench.instruments.samples import SampleBlock
from usmbench.runs.files import AppendedFile
from usmbench.runs.reader import read_run
from usmbench.runs.run_lock import check_free
from usmbench.runs.writer import RunWriter
from usmbench.sweep.rows import WindowRow

Fill = Callable[[RunWriter, int, int], None]
Check = Callable[[Path], None]


def create(folder: Path, meta: dict[str, Any], *, raw: bool = False) -> RunWriter:
    return RunWriter.create(folder, meta, temperature=True, raw=raw)


def said(folder: Path) -> dict[str, Any]:
    content: dict[str, Any] = yaml.safe_load((folder / "run.yaml").read_text())
    return content


def test_a_closed_run_is_as_the_contract_has_it(
    make_run: Callable[..., Path], check_folder: Check
) -> None:
    folder = make_run()
    check_folder(folder)
    assert sorted(p.name for p in folder.iterdir()) == ["pairs.csv", "run.yaml", "windows.csv"]
    assert said(folder)["exit"] == "completed"
    assert datetime.fromisoformat(said(folder)["started"]).tzinfo is not None


def test_every_row_is_readable_as_soon_as_it_is_reported(
    tmp_path: Path, meta: dict[str, Any], window: Callable[[int], WindowRow], check_folder: Check
) -> None:
    writer = create(tmp_path / "run", meta)
    for k in range(3):
        writer.window(window(k))
        assert len(read_run(tmp_path / "run").t_s) == k + 1
    writer.close("interrupted")
    assert said(tmp_path / "run")["exit"] == "interrupted"


def test_ids_differ(tmp_path: Path, meta: dict[str, Any]) -> None:
    ids = set()
    for k in range(20):
        writer = create(tmp_path / f"run{k}", meta)
        writer.close("interrupted")
        ids.add(said(writer.folder)["id"])
    assert len(ids) == 20


def test_rows_are_forced_to_disk_at_each_dwell_and_each_second(
    tmp_path: Path,
    meta: dict[str, Any],
    window: Callable[[int], WindowRow],
    fill: Fill,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    writer = create(tmp_path / "run", meta)
    synced = threading.Semaphore(0)
    now_s = 1000.0
    monkeypatch.setattr(os, "fsync", lambda _: synced.release())
    monkeypatch.setattr(time, "monotonic", lambda: now_s)
    fill(writer, 0, 1)
    assert forced(synced, 2)
    for k in range(3):
        now_s += 0.95
        writer.window(window(10 + k))
        assert forced(synced, 2)
        writer.window(window(20 + k))
    writer.close("completed")
    assert forced(synced, 2)


def forced(synced: threading.Semaphore, files: int) -> bool:
    return all(synced.acquire(timeout=10.0) for _ in range(files))


def test_an_existing_folder_is_left_alone(tmp_path: Path, meta: dict[str, Any]) -> None:
    (tmp_path / "mine.txt").write_text("keep")
    with pytest.raises(InputError, match="exists already"):
        create(tmp_path, meta)
    assert (tmp_path / "mine.txt").read_text() == "keep"


def test_a_folder_that_cannot_be_made_is_an_input_error(
    tmp_path: Path, meta: dict[str, Any]
) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be made"):
        create(tmp_path / "file" / "run", meta)


def full_disk(*_: object) -> int:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_no_space_for_a_new_run_leaves_nothing_behind(
    tmp_path: Path, meta: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "write", full_disk)
    with pytest.raises(InputError, match="no space left"):
        create(tmp_path / "run", meta)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("fits_bytes", [0, 1, 40])
def test_a_full_disk_keeps_the_rows_and_says_what_to_do(
    tmp_path: Path,
    meta: dict[str, Any],
    window: Callable[[int], WindowRow],
    fill: Fill,
    check_folder: Check,
    monkeypatch: pytest.MonkeyPatch,
    fits_bytes: int,
) -> None:
    folder = tmp_path / "run"
    writer = create(folder, meta)
    fill(writer, 0, 2)
    real_write = os.write
    calls = [lambda f, b: real_write(f, b[:fits_bytes]), full_disk]
    monkeypatch.setattr(os, "write", lambda f, b: (calls.pop(0) if calls else full_disk)(f, b))
    with pytest.raises(
        BenchError, match=r"no space left.*safe.*begin again \(.* --resume .*run\)$"
    ):
        writer.window(window(20))
    writer.close("interrupted")
    monkeypatch.undo()
    assert said(folder)["exit"].startswith("failed: ")
    assert len(read_run(folder).t_s) == 20
    check_folder(folder)
    assert RunWriter.resume(folder).stopped_at.last_dwell == 1


def test_closing_on_a_full_disk_does_not_hide_the_first_error(
    make_run: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = make_run(outcome="interrupted")
    writer = RunWriter.resume(folder)
    before = (folder / "run.yaml").read_bytes()
    monkeypatch.setattr(os, "fsync", full_disk)
    writer.close("failed: the board does not answer")
    assert (folder / "run.yaml").read_bytes() == before
    with pytest.raises(BenchError, match="no space left"):
        RunWriter.resume(folder)


def test_closing_says_so_when_it_fails(
    tmp_path: Path, meta: dict[str, Any], fill: Fill, monkeypatch: pytest.MonkeyPatch
) -> None:
    writer = create(tmp_path / "run", meta)
    fill(writer, 0, 1)
    monkeypatch.setattr(os, "fsync", full_disk)
    with pytest.raises(BenchError, match="no space left"):
        writer.close("completed")


def test_resuming_goes_on_after_the_last_whole_row(
    tmp_path: Path, meta: dict[str, Any], fill: Fill, check_folder: Check
) -> None:
    folder = tmp_path / "run"
    writer = create(folder, meta)
    fill(writer, 0, 2)
    writer.close("interrupted")
    with (folder / "windows.csv").open("ab") as file:
        file.write(b"0.21,10,0.2")
    with (folder / "pairs.csv").open("ab") as file:
        file.write(b"10,41")
    resumed = RunWriter.resume(folder)
    assert resumed.stopped_at.last_dwell == 1
    assert resumed.stopped_at.t_s == pytest.approx(0.2)
    assert resumed.stopped_at.sweep == 0
    assert "exit" not in said(folder)
    fill(resumed, 2, 2)
    resumed.close("completed", windows=40)
    check_folder(folder)
    run = read_run(folder)
    assert len(run.t_s) == 40
    assert run.pairs is not None
    assert run.pairs.phase_deg.tolist() == [0.0, 5.0, 10.0, 15.0]
    assert said(folder)["windows"] == 40
    assert len(said(folder)["resumed"]) == 1


def test_resuming_a_closed_run_forgets_how_it_ended(make_run: Callable[..., Path]) -> None:
    folder = make_run(outcome="failed: no data")
    RunWriter.resume(folder)
    assert {"exit", "stopped", "sha256"}.isdisjoint(said(folder))


def test_a_complete_run_and_a_foreign_table_are_not_resumed(make_run: Callable[..., Path]) -> None:
    folder = make_run()
    with pytest.raises(InputError, match="complete"):
        RunWriter.resume(folder)
    (folder / "run.yaml").write_text("format: usmbench-run/1\n")
    (folder / "windows.csv").write_text("t_s,phase_deg,speed_rad_s,mine\n0.01,0,0,1\n")
    with pytest.raises(InputError, match=r"windows.csv:1: the columns"):
        RunWriter.resume(folder)


@pytest.mark.parametrize("name", ["windows.csv", "pairs.csv", "raw.h5"])
def test_a_link_in_the_place_of_data_is_refused(
    tmp_path: Path, make_run: Callable[..., Path], name: str
) -> None:
    folder, victim = make_run(outcome="interrupted"), tmp_path / "victim"
    if (folder / name).exists():
        (folder / name).rename(victim)
    else:
        victim.write_text("dear to somebody")
    with victim.open("ab") as file:
        file.write(b"torn")
    before = victim.read_bytes()
    (folder / name).symlink_to("../victim")
    for takes_up in (check_free, RunWriter.resume):
        with pytest.raises(InputError, match=f"{name}: is a link; put the file itself"):
            takes_up(folder)
    assert victim.read_bytes() == before


def test_a_link_that_is_laid_just_now_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "windows.csv").symlink_to("victim")
    with pytest.raises(BenchError, match=r"windows\.csv"):
        AppendedFile(tmp_path / "windows.csv")
    assert not (tmp_path / "victim").exists()


@pytest.mark.parametrize("name", ["run.yaml.new", ".reserve", ".reserve-raw"])
def test_a_link_in_the_place_of_a_file_that_is_made_new_is_not_followed(
    tmp_path: Path, meta: dict[str, Any], name: str
) -> None:
    folder, victim = tmp_path / "run", tmp_path / "victim"
    create(folder, meta, raw=True).close("interrupted")
    victim.write_text("dear to somebody")
    (folder / name).symlink_to("../victim")
    RunWriter.resume(folder).close("interrupted")
    assert victim.read_text() == "dear to somebody"


KILLED = textwrap.dedent(
    """
    import sys
    from pathlib import Path
    from usmbench.runs.writer import RunWriter
    from usmbench.sweep.rows import PairRow, WindowRow
    writer = RunWriter.create(Path(sys.argv[1]), {"motor": "m", "encoder": {}},
                              temperature=False, raw=False)
    for k in range(10**9):
        t_s = (k + 1) * 0.01
        writer.window(WindowRow(t_s, k // 10 % 90, 1.0, 41e3, 0.0, t_s, 0.01, 0, 1, 1.0, 1))
        if k % 10 == 9:
            writer.pair(PairRow(k // 10 % 90, 41e3, 0.0, 1.0, 0.0, 10, 1, t_s, k // 10, 1))
        print(k + 1, flush=True)
    """
)


def test_a_kill_at_any_instant_loses_no_reported_row(tmp_path: Path) -> None:
    for trial in range(4):
        folder = tmp_path / f"run{trial}"
        child = subprocess.Popen(
            [sys.executable, "-c", KILLED, str(folder)], stdout=subprocess.PIPE, text=True
        )
        assert child.stdout is not None
        child.stdout.readline()
        time.sleep(random.uniform(0.0, 0.2))
        child.kill()
        reported = child.stdout.read().splitlines(keepends=True)
        child.wait()
        child.stdout.close()
        run = read_run(folder)
        last = max((int(line) for line in reported if line.endswith("\n")), default=1)
        assert len(run.t_s) >= last
        stopped_at = RunWriter.resume(folder).stopped_at
        assert stopped_at.last_dwell in (len(run.t_s) // 10 - 1, len(run.t_s) // 10 - 2)


def blocks(first: int, n: int) -> list[SampleBlock]:
    return [
        SampleBlock(k * 1000, np.arange(k * 1000, k * 1000 + 1000), np.full(1000, k))
        for k in range(first, first + n)
    ]


def test_raw_samples_survive_a_writer_that_never_closed(
    tmp_path: Path, meta: dict[str, Any], fill: Fill
) -> None:
    folder = tmp_path / "run"
    script = textwrap.dedent(
        """
        import os, sys
        from pathlib import Path
        import numpy as np
        from usmbench.instruments.samples import SampleBlock
        from usmbench.runs.raw import RawWriter
        writer = RawWriter(Path(sys.argv[1]))
        for k in range(70):
            counts = np.arange(k * 1000, k * 1000 + 1000)
            writer.append(SampleBlock(k * 1000, counts, np.full(1000, k)))
        writer.sync()
        os._exit(9)
        """
    )
    create(folder, meta, raw=True).close("interrupted")
    (folder / "raw.h5").unlink()
    subprocess.run([sys.executable, "-c", script, str(folder / "raw.h5")], check=False)
    with h5py.File(folder / "raw.h5", "r", swmr=True) as file:
        assert len(file["counts"]) == 70_000
    (tmp_path / "victim").write_text("dear to somebody")
    (folder / "raw.h5.new").symlink_to("../victim")
    writer = RunWriter.resume(folder)
    assert (tmp_path / "victim").read_text() == "dear to somebody"
    for block in blocks(70, 2):
        writer.raw(block)
    fill(writer, 0, 1)
    writer.close("completed")
    with h5py.File(folder / "raw.h5", "r") as file:
        assert np.array_equal(file["counts"][:], np.arange(72_000))
        assert np.array_equal(file["first_sample"][:], 1000 * np.arange(72))
        assert np.array_equal(file["index_counts"][::1000], np.arange(72))
    assert "raw.h5" in said(folder)["sha256"]
