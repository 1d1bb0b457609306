"""What steps and edges add to the noise, and what a rotor that runs out keeps of it."""

import numpy as np
import pytest

from held_phases import HOLD, NOISE_RAD_S, held_phases
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.noise.noise_model import LAGS
from usmbench.diagnose.noise.rotor_states import farther_out, runs_out, turns
from usmbench.diagnose.noise.whitening import whitening


def test_rows_of_the_same_jump_are_counted() -> None:
    stretch = held_phases(np.tile([30.0, 60.0, -60.0, 30.0, 60.0], 20))
    # 30 to 60 twice a turn, the others once; the first row of all follows no jump.
    assert stretch.again[HOLD : 5 * HOLD : HOLD].tolist() == [40, 20, 20, 40]
    assert stretch.again[HOLD : 2 * HOLD].tolist() == [40] * HOLD


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_the_share_that_returns_with_a_jump_is_found(share: float) -> None:
    rng = np.random.default_rng(5)
    stretch = held_phases(np.tile(rng.uniform(20.0, 85.0, 250), 8))
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
    stretch = held_phases(rng.uniform(-85.0, 85.0, 1000))
    left = NOISE_RAD_S * rng.standard_normal(stretch.context.n)
    noise = estimate_noise([stretch], [left], [stretch.use])
    assert noise.same_again == pytest.approx(np.ones(LAGS))


def test_a_rotor_that_sticks_at_the_edge_is_noisier_there_and_nowhere_else() -> None:
    rng = np.random.default_rng(7)
    stretch = held_phases(np.r_[rng.uniform(-85.0, 85.0, 2000), rng.uniform(9.0, 12.0, 500)])
    share = farther_out(stretch)
    sticks = (share > 0.015) & (share < 0.03)
    level_rad_s = np.where(sticks, 0.1, NOISE_RAD_S)
    left = level_rad_s * rng.standard_normal(stretch.context.n)
    noise = estimate_noise([stretch], [left], [stretch.use])
    found = noise.level_rad_s(stretch)
    middle = (share > 0.02) & (share < 0.025)
    assert np.median(found[middle]) == pytest.approx(0.1, rel=0.3)
    assert np.median(found[share > 0.1]) == pytest.approx(NOISE_RAD_S, rel=0.1)


def test_the_window_of_a_stop_is_noisier_than_a_rotor_that_stands() -> None:
    """The shaft still turns in it, and brings its noise along: less than a running one has."""
    rng = np.random.default_rng(9)
    stretch = held_phases(np.where(np.arange(500) % 2, 0.0, rng.uniform(30.0, 80.0, 500)))
    stands, stops = np.abs(stretch.settled_rad_s) < 1e-3, stretch.lag == 0
    level_rad_s = np.where(stands, np.where(stops, 0.6, 0.3), 1.0) * NOISE_RAD_S
    left = level_rad_s * rng.standard_normal(stretch.context.n)
    noise = estimate_noise([stretch], [left], [stretch.use])
    found = noise.level_rad_s(stretch)
    assert np.median(found[stands & stops]) == pytest.approx(0.6 * NOISE_RAD_S, rel=0.2)
    assert np.median(found[stands & ~stops]) == pytest.approx(0.3 * NOISE_RAD_S, rel=0.2)


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_a_rotor_that_runs_out_in_the_dead_zone_keeps_its_noise(share: float) -> None:
    """In a multisine it passes through phases at which it would stand, with no step between two."""
    rng = np.random.default_rng(11)
    levels_deg = np.where(np.arange(6000) % 6, rng.uniform(-4.0, 4.0, 6000), 60.0)
    stretch = held_phases(levels_deg, 1)
    turned = np.where(turns(stretch), 1.0, share * runs_out(stretch))
    left = NOISE_RAD_S * turned * rng.standard_normal(stretch.context.n)
    noise = estimate_noise([stretch], [left], [stretch.use])
    assert noise.running_out == pytest.approx(share, rel=0.15)
    rows = (np.abs(stretch.step_rad_s) < 0.1) & (runs_out(stretch) > 0.5)
    assert np.count_nonzero(rows) > 500
    white = np.asarray(whitening(noise, stretch) @ left)[rows]
    assert np.std(white) == pytest.approx(1.0, rel=0.15)


def test_of_one_that_no_run_shows_running_out_nothing_is_taken_for_granted() -> None:
    """A phase that glides tells nothing of a rotor that a step lets run out."""
    up_deg = np.linspace(0.0, 60.0, 1000)
    gliding = held_phases(np.r_[up_deg, up_deg[::-1], np.zeros(2000)], 1)
    stepped = held_phases(np.tile([40.0, 0.0], 50))
    assert np.count_nonzero(runs_out(gliding) > 0.5) < 20
    rng = np.random.default_rng(12)
    left = NOISE_RAD_S * np.where(turns(gliding), 1.0, 0.3) * rng.standard_normal(4000)
    calm_rad_s = estimate_noise([gliding], [left], [gliding.use]).calm_rad_s(stepped)
    out, stands = runs_out(stepped) > 0.9, (runs_out(stepped) < 0.01) & ~turns(stepped)
    assert np.median(calm_rad_s[out]) == pytest.approx(NOISE_RAD_S, rel=0.25)
    assert np.median(calm_rad_s[stands]) == pytest.approx(0.3 * NOISE_RAD_S, rel=0.15)
