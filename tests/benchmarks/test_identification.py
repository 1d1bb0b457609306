"""A small version of every benchmark of the identification."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.identification_coverage import coverage
from benchmarks.identification_few_phases import PHASES_DEG, off_share
from benchmarks.identification_free_run import compare as compare_free_run
from benchmarks.identification_paper import PAPER_SSE, forty_points, from_random_starts
from benchmarks.identification_real import held_out, splits
from benchmarks.identification_scale import gram_s, measured
from benchmarks.identification_speed import FITS, ours
from benchmarks.inverse_map import compare as compare_maps


def test_the_inverse_map_is_the_papers_to_twelve_digits_and_faster() -> None:
    found = compare_maps(20_000, 200)
    assert found["largest difference"] < 1e-12
    assert found["ours, s"] < 0.1 * found["paper, s"]


def test_every_random_start_comes_to_the_papers_sum_of_squares() -> None:
    found = from_random_starts(forty_points(5), 1.01, 3)
    assert found.reached == 3
    assert max(found.rest_sse) < PAPER_SSE
    assert max(found.rest_sse) < 1.01 * min(found.rest_sse)


def test_the_default_method_runs_closer_than_the_papers() -> None:
    table = compare_free_run(small=True, with_peers=False)
    for run in ("staircase", "telegraph"):
        assert table["fast"][run] < table["paper (staircase pairs)"][run]
        assert table["fast"][run] < 1.2 * table["scipy least_squares"][run]


def test_between_few_phases_a_curve_is_nearer_than_a_cubic_spline() -> None:
    own, cubic, _ = off_share(0, PHASES_DEG[0])
    assert own < cubic


def test_intervals_hold_the_truth() -> None:
    found = coverage(12, 0.0, n=1500)
    # 12 of 12 hold with 54 % probability each; 8 or fewer with 0.2 %.
    assert all(share >= 8 / 12 for name, share in found.items() if "alarm" not in name)


def test_a_longer_record_takes_no_more_memory_than_its_rows() -> None:
    (_, few_mb), (_, many_mb) = measured(20_000), measured(100_000)
    assert many_mb - few_mb < 60.0
    assert gram_s(10_000, 58) > 0.0


def test_a_free_run_takes_less_than_a_microsecond_a_row() -> None:
    _, free_run_s = ours(5000, 2, FITS["degree 18"])
    assert free_run_s < 5000 * 20e-6


@pytest.fixture
def others_records(tmp_path: Path) -> Path:
    """Return a folder with records in the formats of the measured ones, of known systems."""
    rng = np.random.default_rng(0)
    volts = np.repeat([0, 2, -2, 4, -4, 8, -8, 6, -6, 0, 2, 6, -2, -6, 4], 250).astype(float)
    settled = np.sign(volts) * np.maximum(np.abs(volts) - 3.0, 0.0) * 40.0
    motor = tmp_path / "dc-motor-dead-zone" / "run_minimal.csv"
    drives = tmp_path / "coupled-drives" / "DATAUNIF.csv"
    for path in (motor, drives):
        path.parent.mkdir()
    rows = [
        f"{0.02 * t:g},{u},{y},up"
        for t, (u, y) in enumerate(zip(volts, _lagged(settled, rng), strict=True))
    ]
    motor.write_text("\n".join(["time,voltage,rpm,direction", *rows]) + "\n")
    u = rng.uniform(-2.0, 2.0, (2, 60)).repeat(8, axis=1)
    z = [_lagged(np.tanh(column), rng, 0.01) for column in u]
    lines = [",".join(f"{value:g}" for value in row) + "," for row in zip(*u, *z, strict=True)]
    drives.write_text("\n".join(['"u11","u12","z11","z12",', *lines]) + "\n")
    return tmp_path


def _lagged(settled: np.ndarray, rng: np.random.Generator, noise: float = 1.0) -> np.ndarray:
    """First-order lag of ten samples, with noise."""
    out, state = np.empty(settled.size), settled[0]
    for k, value in enumerate(settled):
        state += 0.1 * (value - state)
        out[k] = state
    return np.asarray(np.round(out + noise * rng.standard_normal(out.size), 3))


def test_records_of_others_are_read_and_a_dead_zone_is_found(others_records: Path) -> None:
    motor, first, _ = splits(others_records)
    own, _ = held_out(motor, None)
    linear, _ = held_out(motor, 1)
    assert own < 0.8 * linear
    assert first.held.sum() == 100
