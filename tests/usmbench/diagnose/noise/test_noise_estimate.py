"""The noise of a rotor that turns or stands, by rows that tell it."""

from dataclasses import replace

import numpy as np
import pytest

from held_phases import NOISE_RAD_S, held_phases
from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.noise.rotor_states import turns
from usmbench.diagnose.noise.whitening import whitening


def test_where_the_phase_glides_the_noise_is_not_that_of_its_few_crests() -> None:
    rng = np.random.default_rng(8)
    turned = 2.0 * np.pi * np.outer(np.arange(1200) / 1200, np.arange(1, 40))
    waves = np.sum(np.cos(turned + rng.uniform(0.0, 2.0 * np.pi, 39)), axis=1)
    stretch = held_phases(np.round(80.0 * waves / np.max(np.abs(waves)), 1), 1)
    crests = stretch.lag > 0
    assert 5 < np.count_nonzero(crests) < 50
    # The curve follows what it meets there.
    left = np.where(crests, 0.1, 1.0) * NOISE_RAD_S * rng.standard_normal(stretch.context.n)
    noise = estimate_noise([stretch], [left], [stretch.use])
    assert np.median(noise.calm_rad_s(stretch)) == pytest.approx(NOISE_RAD_S, rel=0.3)


def test_a_warm_up_at_one_phase_does_not_tell_the_noise_of_all() -> None:
    rng = np.random.default_rng(8)
    # The rotor stands below 10°: rows without a step, which tell as little.
    stretch = held_phases(
        np.r_[np.full(50, 90.0), np.full(50, 0.0), rng.uniform(-85.0, 85.0, 1000)]
    )
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
    stretch = held_phases(np.sort(levels_deg))
    left = NOISE_RAD_S * turns(stretch) * rng.standard_normal(stretch.context.n)
    noise = estimate_noise([stretch], [left], [stretch.use])
    white = np.asarray(whitening(noise, stretch) @ left)
    assert np.std(white[turns(stretch)]) == pytest.approx(1.0, rel=0.05)


def _at_rest_mostly(seed: int) -> tuple[Stretch, Mask]:
    """Return a run at another phase in nearly every window, and the rows without a step."""
    rng, n = np.random.default_rng([seed, 12]), 3000
    phase_deg = rng.uniform(-85.0, 85.0, n) * np.where(rng.random(n) < 0.75, 0.09, 1.0)
    phase_deg[1::50] = phase_deg[:-1:50]
    settled_rad_s = 0.1 * (phase_deg - phase_deg.clip(-9.0, 9.0))
    stands = settled_rad_s == 0.0
    waving_rad_s = settled_rad_s + 0.02 * NOISE_RAD_S * rng.standard_normal(n)
    stretch = replace(
        held_phases(phase_deg, 1),
        settled_rad_s=waving_rad_s,
        simulated_rad_s=waving_rad_s,
        step_rad_s=np.diff(waving_rad_s, prepend=waving_rad_s[0]),
    )
    return stretch, stands & np.r_[True, stands[:-1]]


def test_a_rotor_that_stands_shows_its_noise_though_its_curve_waves_a_little() -> None:
    """By 1700 rows, which tell it to 3 %: sixty, of phases that stay, tell it to 8 %."""
    levels = []
    for seed in range(20):
        stretch, still = _at_rest_mostly(seed)
        left = NOISE_RAD_S * np.random.default_rng(seed).standard_normal(still.size)
        noise = estimate_noise([stretch], [left], [stretch.use])
        levels.append(np.mean(noise.level_rad_s(stretch)[still]) / NOISE_RAD_S)
    assert np.mean(levels) == pytest.approx(1.0, abs=0.05)
    assert np.std(levels) < 0.05
