import numpy as np
import pytest

from usmbench.watch.trace import Trace


def filled(trace: Trace, n: int, at_once: int) -> Trace:
    rng = np.random.default_rng(1)
    t_s = 0.01 * np.arange(1.0, n + 1.0)
    speed_rad_s = rng.standard_normal(n)
    for start in range(0, n, at_once):
        part = slice(start, start + at_once)
        trace.add(t_s[part], speed_rad_s[part], 0.5 * speed_rad_s[part])
    return trace


@pytest.mark.parametrize("n", [10, 600, 601, 40_000])
def test_the_whole_run_stays_with_its_extremes_in_bounded_memory(n: int) -> None:
    columns = filled(Trace(600, 1, whole=True), n, 50).columns()
    speed_rad_s = np.random.default_rng(1).standard_normal(n)
    n_buckets = len(columns["t_s"])
    assert n_buckets < 600
    stride = next(2**k for k in range(20) if n // 2**k < 600)
    assert n_buckets == n // stride
    covered = speed_rad_s[: n_buckets * stride]
    assert columns["low_rad_s"].min() == covered.min()
    assert columns["high_rad_s"].max() == covered.max()
    assert columns["mean_rad_s"].mean() == pytest.approx(covered.mean())
    assert columns["residual_high_rad_s"].max() == pytest.approx(0.5 * covered.max())
    assert columns["t_s"][-1] == pytest.approx(0.01 * n_buckets * stride)
    assert np.all(np.diff(columns["t_s"]) > 0)


def test_it_does_not_matter_how_many_rows_come_at_once() -> None:
    one = filled(Trace(600, 1, whole=True), 5000, 7).columns()
    other = filled(Trace(600, 1, whole=True), 5000, 5000).columns()
    for name, column in one.items():
        np.testing.assert_allclose(column, other[name])


def test_the_latest_are_kept_where_that_is_wanted() -> None:
    columns = filled(Trace(500, 4, whole=False), 10_000, 30).columns()
    assert len(columns["t_s"]) == 500
    assert columns["t_s"][-1] == pytest.approx(100.0)
    assert columns["t_s"][0] == pytest.approx(100.0 - 499 * 0.04)


def test_rows_without_a_simulation_have_no_residual() -> None:
    trace = Trace(600, 2, whole=True)
    trace.add(np.array([0.01, 0.02]), np.array([1.0, 3.0]), np.array([np.nan, 3.0]))
    columns = trace.columns()
    assert columns["mean_rad_s"].tolist() == [2.0]
    assert np.isnan(columns["simulated_rad_s"]).all()
    assert np.isnan(columns["residual_low_rad_s"]).all()
