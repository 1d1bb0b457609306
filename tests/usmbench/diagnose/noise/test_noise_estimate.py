"""The noise of a rotor that turns, stands or runs out, and what steps and edges add to it."""

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.noise.noise_model import LAGS
from usmbench.diagnose.noise.rotor_states import farther_out, runs_out, turns
from usmbench.diagnose.noise.whitening import whitening
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.runs.record import Record

Array = NDArray[np.float64]
WINDOW_S, NOISE_RAD_S, HOLD = 0.01, 0.01, 4
PHASE_DEG = np.linspace(-90.0, 90.0, 181)
CREST_RAD_S = 10.0 * np.sin(np.radians(PHASE_DEG))
CURVE = StaticCurve(PHASE_DEG, np.sign(PHASE_DEG) * np.maximum(np.abs(CREST_RAD_S) - 1.7, 0.0))
MODEL = HammersteinModel(
    first_order(0.0035, 0.0015, WINDOW_S),
    (OperatingPoint(None, None, CURVE, (-90.0, 90.0), (None, None), NOISE_RAD_S),),
    "test",
)


def _stretch(levels_deg: Array, hold: int = HOLD) -> Stretch:
    phase_deg = np.repeat(levels_deg, hold)
    n = phase_deg.size
    t_s = WINDOW_S * np.arange(1.0, n + 1.0)
    record = Record("run", t_s, phase_deg, np.zeros(n), np.full(n, WINDOW_S))
    (stretch,), _ = cut_runs([record], MODEL, ())
    return stretch


def test_rows_of_the_same_jump_are_counted() -> None:
    stretch = _stretch(np.tile([30.0, 60.0, -60.0, 30.0, 60.0], 20))
    # 30 to 60 twice a turn, the others once; the first row of all follows no jump.
    assert stretch.again[HOLD : 5 * HOLD : HOLD].tolist() == [40, 20, 20, 40]
    assert stretch.again[HOLD : 2 * HOLD].tolist() == [40] * HOLD


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_the_share_that_returns_with_a_jump_is_found(share: float) -> None:
    rng = np.random.default_rng(5)
    stretch = _stretch(np.tile(rng.uniform(20.0, 85.0, 250), 8))
    n_jumps = stretch.context.n // HOLD
    same = np.tile(rng.standard_normal(n_jumps // 8), 8)
    drawn = np.sqrt(share) * same + np.sqrt(1.0 - share) * rng.standard_normal(n_jumps)
    left = NOISE_RAD_S * rng.standard_normal(stretch.context.n)
    left[::HOLD] = 0.1 * drawn
    noise = estimate_noise([stretch], [left], [stretch.use])
    assert noise.same_again[0] == pytest.approx(share, abs=0.1)
    rows = np.flatnonzero((stretch.lag == 0) & (stretch.again == 8))
    level = float(np.median(noise.level_rad_s(stretch)[rows]))
    # Eight rows weigh as much as what they tell of the jump's mean.
    assert level / 0.1 == pytest.approx(np.sqrt(1.0 + 7.0 * noise.same_again[0]), rel=0.15)


def test_where_no_jump_repeats_all_of_it_may_return() -> None:
    rng = np.random.default_rng(6)
    stretch = _stretch(rng.uniform(-85.0, 85.0, 1000))
    left = NOISE_RAD_S * rng.standard_normal(stretch.context.n)
    noise = estimate_noise([stretch], [left], [stretch.use])
    assert noise.same_again == pytest.approx(np.ones(LAGS))


def test_a_rotor_that_sticks_at_the_edge_is_noisier_there_and_nowhere_else() -> None:
    rng = np.random.default_rng(7)
    stretch = _stretch(np.r_[rng.uniform(-85.0, 85.0, 2000), rng.uniform(9.0, 12.0, 500)])
    share = farther_out(stretch)
    sticks = (share > 0.015) & (share < 0.03)
    level_rad_s = np.where(sticks, 0.1, NOISE_RAD_S)
    left = level_rad_s * rng.standard_normal(stretch.context.n)
    noise = estimate_noise([stretch], [left], [stretch.use])
    found = noise.level_rad_s(stretch)
    middle = (share > 0.02) & (share < 0.025)
    assert np.median(found[middle]) == pytest.approx(0.1, rel=0.3)
    assert np.median(found[share > 0.1]) == pytest.approx(NOISE_RAD_S, rel=0.1)


def test_where_the_phase_glides_the_noise_is_not_that_of_its_few_crests() -> None:
    rng = np.random.default_rng(8)
    turned = 2.0 * np.pi * np.outer(np.arange(1200) / 1200, np.arange(1, 40))
    waves = np.sum(np.cos(turned + rng.uniform(0.0, 2.0 * np.pi, 39)), axis=1)
    stretch = _stretch(np.round(80.0 * waves / np.max(np.abs(waves)), 1), 1)
    crests = stretch.lag > 0
    assert 5 < np.count_nonzero(crests) < 50
    # The curve follows what it meets there.
    left = np.where(crests, 0.1, 1.0) * NOISE_RAD_S * rng.standard_normal(stretch.context.n)
    noise = estimate_noise([stretch], [left], [stretch.use])
    assert np.median(noise.calm_rad_s(stretch)) == pytest.approx(NOISE_RAD_S, rel=0.3)


def test_the_window_of_a_stop_is_noisier_than_a_rotor_that_stands() -> None:
    """The shaft still turns in it, and brings its noise along: less than a running one has."""
    rng = np.random.default_rng(9)
    stretch = _stretch(np.where(np.arange(500) % 2, 0.0, rng.uniform(30.0, 80.0, 500)))
    stands, stops = np.abs(stretch.settled_rad_s) < 1e-3, stretch.lag == 0
    level_rad_s = np.where(stands, np.where(stops, 0.6, 0.3), 1.0) * NOISE_RAD_S
    left = level_rad_s * rng.standard_normal(stretch.context.n)
    noise = estimate_noise([stretch], [left], [stretch.use])
    found = noise.level_rad_s(stretch)
    assert np.median(found[stands & stops]) == pytest.approx(0.6 * NOISE_RAD_S, rel=0.2)
    assert np.median(found[stands & ~stops]) == pytest.approx(0.3 * NOISE_RAD_S, rel=0.2)


def test_a_warm_up_at_one_phase_does_not_tell_the_noise_of_all() -> None:
    rng = np.random.default_rng(8)
    # The rotor stands below 10°: rows without a step, which tell as little.
    stretch = _stretch(np.r_[np.full(50, 90.0), np.full(50, 0.0), rng.uniform(-85.0, 85.0, 1000)])
    stands = np.abs(stretch.context.phase_deg) < 8.0
    left = np.where(stands, 0.1, 1.0) * NOISE_RAD_S * rng.standard_normal(stretch.context.n)
    noise = estimate_noise([stretch], [left], [stretch.use])
    rows = (np.abs(stretch.context.phase_deg) > 15.0) & (stretch.lag > 0)
    assert noise.calm_rad_s(stretch)[rows] == pytest.approx(NOISE_RAD_S, rel=0.25)


@pytest.mark.parametrize("stands", [0.3, 0.7])
def test_a_rotor_that_stands_without_noise_does_not_make_that_of_one_that_turns_less(
    stands: float,
) -> None:
    rng = np.random.default_rng(10)
    levels_deg = np.where(rng.random(1000) < stands, 0.0, rng.uniform(20.0, 85.0, 1000))
    stretch = _stretch(np.sort(levels_deg))
    left = NOISE_RAD_S * turns(stretch) * rng.standard_normal(stretch.context.n)
    noise = estimate_noise([stretch], [left], [stretch.use])
    white = np.asarray(whitening(noise, stretch) @ left)
    assert np.std(white[turns(stretch)]) == pytest.approx(1.0, rel=0.05)


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_a_rotor_that_runs_out_in_the_dead_zone_keeps_its_noise(share: float) -> None:
    """In a multisine it passes through phases at which it would stand, with no step between two."""
    rng = np.random.default_rng(11)
    levels_deg = np.where(np.arange(6000) % 6, rng.uniform(-4.0, 4.0, 6000), 60.0)
    stretch = _stretch(levels_deg, 1)
    turned = np.where(turns(stretch), 1.0, share * runs_out(stretch))
    left = NOISE_RAD_S * turned * rng.standard_normal(stretch.context.n)
    noise = estimate_noise([stretch], [left], [stretch.use])
    assert noise.running_out == pytest.approx(share, rel=0.15)
    rows = (np.abs(stretch.step_rad_s) < 0.1) & (runs_out(stretch) > 0.5)
    assert np.count_nonzero(rows) > 500
    white = np.asarray(whitening(noise, stretch) @ left)[rows]
    assert np.std(white) == pytest.approx(1.0, rel=0.15)
