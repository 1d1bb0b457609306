"""A sweep with raw samples on a disk that is full, or too full to begin.

Full for raw.h5 alone: that is what a limit to a file's size is, and anybody may set it.
"""

import subprocess
import sys
from pathlib import Path

import h5py
import yaml


def _sweep(tmp_path: Path, blocks: int, status: int) -> str:
    """Sweep where no file may have more blocks; return the one line that is said of it."""
    limited = ["sh", "-c", f'ulimit -f {blocks} && exec "$@"', "sh", sys.executable]
    command = ["sweep", "phase-sweep", "--bench", "simulated", "--raw", "--out", "run"]
    done = subprocess.run(
        [*limited, "-m", "usmbench", *command],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=100.0,
    )
    assert done.returncode == status, done.stderr
    assert done.stderr.count("\n") == 1
    assert "raw.h5: the counter samples cannot be kept" in done.stderr
    return done.stderr


def test_it_ends_in_good_order(tmp_path: Path) -> None:
    _sweep(tmp_path, 600, 3)
    folder = tmp_path / "run"
    meta = yaml.safe_load((folder / "run.yaml").read_text())
    assert meta["exit"].startswith("failed: ")
    assert set(meta["sha256"]) == {"windows.csv", "pairs.csv"}
    assert {file.name for file in folder.iterdir()} == {"run.yaml", "raw.h5", *meta["sha256"]}
    with h5py.File(folder / "raw.h5", "r", libver="latest", swmr=True) as file:
        written = file["counts"][:]
    assert written.size > 0


def test_where_it_cannot_begin_the_mend_is_told_once(tmp_path: Path) -> None:
    assert _sweep(tmp_path, 200, 2).count("free some space") == 1
    assert not (tmp_path / "run").exists()
