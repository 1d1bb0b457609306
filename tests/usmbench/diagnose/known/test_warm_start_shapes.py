"""What a warm motor shows at the start of a run."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.cutting.warmth import TIME_CONSTANTS_S, warmth
from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.features_of_runs import features_of
from usmbench.diagnose.known.warm_start_shapes import (
    histories,
    warm_means,
    warm_root,
    warm_shapes,
)

BEFORE_S, CONSTANTS = 40.0, 3


@pytest.fixture
def features(stretches: list[Stretch]) -> Features:
    return replace(features_of(stretches), n_constants=CONSTANTS)


def test_a_run_after_a_drive_shows_the_warm_start_beside_what_it_warms_itself(
    stretches: list[Stretch], features: Features
) -> None:
    """Driven at half the highest speed before and in the run, so that only time counts."""
    (stretch,) = stretches
    top_rad_s, window_s = features.top_rad_s, stretch.context.window_s
    n, n_before = stretch.context.n, round(BEFORE_S / window_s)
    powers = (1.0, 0.5 * top_rad_s, top_rad_s**2)
    t_s = window_s * np.arange(1.0, n_before + n + 1.0)
    (cold, warm) = (
        warmth(t_s, window_s, [np.full(t_s.size, p) for p in powers], [np.empty(0)] * 3, [rows])[0]
        for rows in (np.arange(n), n_before + np.arange(n))
    )
    left = 0.01 * np.random.default_rng(3).standard_normal(len(features.groups))
    shown_cold, shown_warm = (
        features.combined(replace(stretch, warmth=w), left) for w in (cold, warm)
    )
    shares = -np.expm1(-BEFORE_S / np.array(TIME_CONSTANTS_S[:CONSTANTS]))
    columns = warm_shapes(stretch, features) @ warm_means(features, left)
    assert columns.shape == (n, CONSTANTS)
    assert np.max(np.abs(columns @ shares)) > 0.01
    assert columns @ shares == pytest.approx(shown_warm - shown_cold, abs=1e-9)


def test_what_is_not_known_of_the_warm_up_is_not_known_of_a_warm_start(
    features: Features,
) -> None:
    rng = np.random.default_rng(4)
    n = len(features.groups)
    left, root = rng.standard_normal(n), rng.standard_normal((n, n))
    sure, unsure = warm_root(features, left, 0.0 * root), warm_root(features, left, root)
    drawn = warm_means(features, left) @ histories(features.n_constants).T
    warm, known = drawn @ drawn.T / drawn.shape[1], root[features.warms_at >= 0]
    np.testing.assert_allclose(sure @ sure.T, warm, atol=1e-9)
    np.testing.assert_allclose(unsure @ unsure.T, warm + known @ known.T, atol=1e-9)


def test_a_motor_that_stood_is_warm_only_where_heat_lasts() -> None:
    shares = histories(5)
    assert np.all((shares >= 0.0) & (shares <= 1.0))
    assert np.any(np.all(shares > 0.95, axis=1))
    stood = shares[shares[:, 0] < 1e-3]
    assert np.all(stood[:, 0] <= stood[:, -1])
    assert np.max(stood[:, -1]) > 0.5


@pytest.mark.parametrize("steepest_rad_s", [None, 3.0])
def test_every_shape_of_warming_belongs_to_one_time_constant(
    stretches: list[Stretch], features: Features, steepest_rad_s: float | None
) -> None:
    """With one constant warm all others stay as they are."""
    (stretch,) = stretches
    features = replace(features, steepest_rad_s=steepest_rad_s)
    none = np.zeros_like(stretch.warmth)
    cold = np.column_stack(list(features.columns(replace(stretch, warmth=none))))
    for k in range(CONSTANTS):
        one = none.copy()
        one[:, k] = np.array([[1.0], [0.7], [3.0]])
        warm = np.column_stack(list(features.columns(replace(stretch, warmth=one))))
        changed = np.any(warm != cold, axis=0)
        assert set(np.flatnonzero(changed)) <= set(np.flatnonzero(features.warms_at == k))
        assert np.any(changed)
