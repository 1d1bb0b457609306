"""How much an extension gains, and how sure that is."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.fitting.gain import gain_of_blocks, held_out_gain, left_over
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.hammerstein import HammersteinModel


def scores(before: float, after: float, floor: float, blocks: int = 40) -> np.ndarray:
    """Return sums of squares of blocks of 50 rows, alike but for chance."""
    rows = np.full(blocks, 50.0)
    chance = 1.0 + 0.05 * np.random.default_rng(1).standard_normal(blocks)
    return np.array([before * rows * chance, after * rows * chance, floor * rows, rows])


@pytest.mark.parametrize(("before", "least"), [(1.1, 0.0), (1.2, 0.2), (20.0, 0.97)])
def test_a_small_gain_is_as_unsure_as_the_noise_that_it_is_measured_by(
    before: float, least: float
) -> None:
    """Where the noise is said to be louder than what is left, the share is all of it, at most."""
    gain = gain_of_blocks(scores(before, 1.0, 1.05))
    assert gain.gain == gain.high == 1.0
    assert least < gain.low < 1.0
    assert before > 10.0 or gain.low < 0.9


@given(st.floats(0.5, 30.0), st.floats(0.5, 30.0), st.floats(0.1, 5.0))
def test_the_interval_holds_the_gain(before: float, after: float, floor: float) -> None:
    gain = gain_of_blocks(scores(before, after, floor))
    assert 0.0 <= gain.low <= gain.gain <= gain.high <= 1.0
    assert gain.noise_floor_rad_s <= max(gain.rmse_extended_rad_s, np.sqrt(floor)) + 1e-9


@pytest.mark.parametrize("jitter", [2.0, 20.0])
def test_what_steps_leave_is_error_and_no_noise(
    model: HammersteinModel, stretches: list[Stretch], jitter: float
) -> None:
    """However large it is said to be: the gain is what it would be without, above the noise."""
    noise_rad_s, rng = 0.02, np.random.default_rng(3)
    (stretch,) = stretches
    effect_rad_s = np.full(stretch.context.n, 3.0 * noise_rad_s)
    late_rad_s = np.where(stretch.lag == 0, 10.0 * noise_rad_s, 0.0)
    left_rad_s = noise_rad_s * rng.standard_normal(stretch.context.n) + late_rad_s + effect_rad_s
    stretch = replace(stretch, speed_rad_s=stretch.simulated_rad_s + left_rad_s)
    noise = estimate_noise([stretch], [left_rad_s - effect_rad_s - late_rad_s], [stretch.use])
    steps_rad_s = np.full_like(noise.step_spread_rad_s, jitter * noise_rad_s)
    noise = replace(noise, step_spread_rad_s=steps_rad_s)
    problem = Problem([stretch], knowledge_of(model), noise, [stretch.use])
    gain = held_out_gain(problem, [effect_rad_s])
    before, after = (np.mean((left_rad_s - c)[stretch.use] ** 2) for c in (0.0, effect_rad_s))
    assert gain.noise_floor_rad_s == pytest.approx(noise_rad_s, rel=0.15)
    assert gain.gain == pytest.approx((before - after) / (before - noise_rad_s**2), abs=0.02)
    assert (left_over(problem, [effect_rad_s]) > 1.0) == (jitter < 10.0)
