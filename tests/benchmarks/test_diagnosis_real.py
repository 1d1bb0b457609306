"""Stand-ins for the records that others have measured: the same formats, known systems."""

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

from benchmarks.diagnosis_real import blind, lopsided
from benchmarks.identification_real import Split, splits


@pytest.fixture
def records(tmp_path: Path) -> list[Split]:
    """Return a motor that is faster backwards, and drives on a belt behind a blind tachometer."""
    rng = np.random.default_rng(0)
    volts = np.repeat([0, 2, 4, 6, 8, 5, 7, 3, 0, -2, -4, -6, -8, -5, -7, -3, 0], 150).astype(float)
    volts = np.where((volts == 0.0) | (np.abs(volts) > 2.0), volts, 0.5 * volts)
    settled = np.where(volts < 0.0, 1.15, 1.0) * np.sign(volts) * 30.0 * np.abs(volts)
    speed = lfilter([0.02], [1.0, -1.5, 0.52], settled) + rng.standard_normal(volts.size)
    rows = [f"{0.02 * k:g},{u},{y}" for k, (u, y) in enumerate(zip(volts, speed, strict=True))]
    motor = tmp_path / "dc-motor-dead-zone" / "run_minimal.csv"
    u = rng.uniform(-1.5, 2.5, (2, 100)).repeat(5, axis=1)
    belt = lfilter([0.006, 0.018, 0.006], [1.0, -2.45, 2.17, -0.69], u, axis=1)
    z = np.abs(belt) + 0.02 * rng.standard_normal(u.shape)
    lines = [",".join(f"{value:g}" for value in row) + "," for row in zip(*u, *z, strict=True)]
    drives = tmp_path / "coupled-drives" / "DATAUNIF.csv"
    for path in (motor, drives):
        path.parent.mkdir()
    motor.write_text("\n".join(["time,voltage,rpm", *rows]) + "\n")
    drives.write_text("\n".join(['"u11","u12","z11","z12",', *lines]) + "\n")
    return splits(tmp_path)


def test_the_asymmetry_is_named(records: list[Split], tmp_path: Path) -> None:
    causes = lopsided(records[0], tmp_path)
    assert causes[0]["name"] == "gain_asymmetry"


def test_the_loss_of_sign_is_named_and_the_free_run_mended(
    records: list[Split], tmp_path: Path
) -> None:
    (cause,), before, after = blind(records[1], tmp_path)
    assert cause["name"] == "unsigned_counts"
    assert after < 0.2 * before
