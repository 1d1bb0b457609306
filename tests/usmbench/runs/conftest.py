"""Rows, folders and the checker of the run folder's contract."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from usmbench.runs.catalogue import changed_data
from usmbench.runs.reader import read_run
from usmbench.runs.writer import RunWriter
from usmbench.sweep.rows import PairRow, WindowRow

META: dict[str, Any] = {
    "motor": "Shinsei USR60",
    "encoder": {"counts_per_rev": 2000, "sample_rate_hz": 100e3, "samples_per_average": 1000},
    "plan": {"name": "phase-sweep", "frequency_limits_hz": (40e3, 42e3)},
}
CHECKER = Path(__file__).parents[3] / "../shared/tools/check-contract"


def _window(k: int) -> WindowRow:
    """Return the k-th window of a plain run, from 0."""
    return WindowRow(
        t_s=(k + 1) * 0.01,
        phase_deg=float(k // 10 * 5),
        speed_rad_s=0.1 * (k // 10) + 1e-3 * (k % 3),
        frequency_hz=41_000.0,
        torque_nm=0.1,
        angle_rad=0.01 * k,
        window_s=0.01,
        sweep=0,
        settled=int(k % 10 >= 5),
        average_rad_s=0.3,
        drive_on=1,
        temperature_c=25.0 + 1e-3 * k,
    )


def _pair(dwell: int) -> PairRow:
    """Return the pair of the dwell that ends with window 10 dwell + 9."""
    return PairRow(
        phase_deg=dwell * 5.0,
        frequency_hz=41_000.0,
        torque_nm=0.1,
        speed_rad_s=0.1 * dwell,
        speed_std_rad_s=1e-3,
        n_windows=5,
        direction=1,
        t_s=(dwell + 1) * 0.1,
        dwell=dwell,
        settled=1,
    )


def _fill(writer: RunWriter, first_dwell: int, dwells: int) -> None:
    """Write whole dwells of ten windows."""
    for dwell in range(first_dwell, first_dwell + dwells):
        for k in range(10 * dwell, 10 * dwell + 10):
            writer.window(_window(k))
        writer.pair(_pair(dwell))


def _check_folder(folder: Path) -> None:
    """Hold a folder against the contract, by its own checker where that is at hand."""
    read_run(folder)
    assert changed_data(folder) == []
    if CHECKER.exists():
        done = subprocess.run(
            [sys.executable, str(CHECKER), "run", str(folder)], capture_output=True, text=True
        )
        assert done.returncode == 0, done.stdout


@pytest.fixture
def meta() -> dict[str, Any]:
    """What a sweep hands to the writer."""
    return dict(META)


@pytest.fixture
def window() -> Callable[[int], WindowRow]:
    """Make the k-th window of a plain run."""
    return _window


@pytest.fixture
def fill() -> Callable[[RunWriter, int, int], None]:
    """Write so many dwells from a first one on."""
    return _fill


@pytest.fixture
def check_folder() -> Callable[[Path], None]:
    """Hold a folder against the contract."""
    return _check_folder


@pytest.fixture
def make_run(tmp_path: Path) -> Callable[..., Path]:
    """Make a closed run folder of so many dwells."""

    def make(dwells: int = 3, outcome: str = "completed") -> Path:
        writer = RunWriter.create(tmp_path / "run", META, temperature=True, raw=False)
        _fill(writer, 0, dwells)
        writer.close(outcome)
        return writer.folder

    return make
