"""raw.h5 on a disk that is full: closed or let be, never a crash, never a sample that was not."""

import subprocess
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import yaml

from usmbench.errors import BenchError
from usmbench.instruments.samples import SampleBlock
from usmbench.runs.raw import RawWriter
from usmbench.runs.writer import RunWriter

# A limit to a file's size is a disk that is full for raw.h5 alone.
UNTIL_FULL = textwrap.dedent(
    """
    import resource, sys
    from pathlib import Path
    import numpy as np
    from usmbench.errors import BenchError
    from usmbench.instruments.samples import SampleBlock
    from usmbench.runs.writer import RunWriter
    from usmbench.sweep.rows import PairRow, WindowRow
    folder, forced_every, freed = Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3] == "freed"
    writer = RunWriter.create(folder, {"motor": "m", "encoder": {}}, temperature=False, raw=True)
    resource.setrlimit(resource.RLIMIT_FSIZE, (600_000, resource.RLIM_INFINITY))
    noise = np.random.default_rng(1).integers(0, 1 << 40, 1000)
    try:
        for k in range(10**6):
            writer.raw(SampleBlock(k * 1000, noise + k, np.full(1000, k)))
            if k % forced_every == forced_every - 1:
                t_s = (k + 1) / 100
                writer.window(WindowRow(t_s, 0, 1, 41e3, 0, t_s, 0.01, 0, 1, 1, 1))
                writer.pair(PairRow(0, 41e3, 0, 1, 0, 5, 1, t_s, k, 1))
    except BenchError as error:
        print(error)
    if freed:
        resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)
    writer.close("interrupted")
    sys.exit(3)
    """
)


def expected(first: int, n: int) -> np.ndarray[Any, np.dtype[np.int64]]:
    noise = np.random.default_rng(1).integers(0, 1 << 40, 1000)
    return np.add.outer(np.arange(first, first + n), noise).ravel()


def fill_the_disk(folder: Path, forced_every: int, then: str) -> dict[str, Any]:
    command = [sys.executable, "-c", UNTIL_FULL, str(folder), str(forced_every), then]
    done = subprocess.run(command, capture_output=True, text=True, timeout=100.0)
    assert done.returncode == 3, done.stderr
    assert done.stderr == ""
    assert done.stdout.count("\n") == 1
    assert "raw.h5: the counter samples cannot be kept" in done.stdout
    meta: dict[str, Any] = yaml.safe_load((folder / "run.yaml").read_text())
    assert meta["exit"].startswith("failed: ")
    assert sorted(file.name for file in folder.iterdir() if file.name[0] == ".") == []
    return meta


def holds_what_was_measured(path: Path) -> int:
    with h5py.File(path, "r") as file:
        n = len(file["block_samples"])
        assert np.array_equal(file["first_sample"][:], 1000 * np.arange(n))
        assert np.array_equal(file["block_samples"][:], np.full(n, 1000))
        assert np.array_equal(file["counts"][:], expected(0, n))
        index = file["index_counts"][:]
        assert set((index - np.arange(n).repeat(1000)[: len(index)])[index >= 0]) <= {0}
    return n


def go_on(folder: Path, n: int) -> None:
    writer = RunWriter.resume(folder)
    for k in range(n, n + 3):
        writer.raw(SampleBlock(k * 1000, expected(k, 1), np.full(1000, k)))
    writer.close("completed")


@pytest.mark.parametrize("forced_every", [7, 90, 100_000])
def test_once_there_is_space_the_file_is_closed_with_the_last_whole_block(
    tmp_path: Path, forced_every: int
) -> None:
    folder = tmp_path / "run"
    meta = fill_the_disk(folder, forced_every, "freed")
    assert "raw.h5" in meta["sha256"]
    n = holds_what_was_measured(folder / "raw.h5")
    assert n > 0
    go_on(folder, n)
    assert holds_what_was_measured(folder / "raw.h5") == n + 3


@pytest.mark.parametrize("forced_every", [7, 90, 100_000])
def test_where_there_is_none_the_file_is_let_be_and_the_run_is_closed(
    tmp_path: Path, forced_every: int
) -> None:
    folder = tmp_path / "run"
    meta = fill_the_disk(folder, forced_every, "still full")
    assert set(meta["sha256"]) == {"windows.csv", "pairs.csv"}
    RunWriter.resume(folder).close("interrupted")
    n = holds_what_was_measured(folder / "raw.h5")
    go_on(folder, n)
    assert holds_what_was_measured(folder / "raw.h5") == n + 3


def test_a_run_whose_samples_cannot_be_closed_is_not_complete(
    tmp_path: Path,
    meta: dict[str, Any],
    fill: Callable[[RunWriter, int, int], None],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def broken(raw: RawWriter) -> None:
        raise BenchError(f"{raw.path.name} broken")

    writer = RunWriter.create(tmp_path / "run", meta, temperature=False, raw=True)
    fill(writer, 0, 1)
    with monkeypatch.context() as patched:
        patched.setattr(RawWriter, "close", broken)
        with pytest.raises(BenchError, match=r"raw\.h5 broken"):
            writer.close("completed")
    said = yaml.safe_load((tmp_path / "run" / "run.yaml").read_text())
    assert said["exit"] == "failed: raw.h5 broken"
    assert set(said["sha256"]) == {"windows.csv", "pairs.csv"}
