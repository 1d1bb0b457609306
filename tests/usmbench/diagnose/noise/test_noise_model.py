"""The noise of a free run: what jumps of the phase add to it, by their size and kind."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.noise.noise_model import noise_from_mapping
from usmbench.diagnose.noise.rotor_states import step_kind
from usmbench.model.applied import Applied
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.runs.record import Record

Array = NDArray[np.float64]
WINDOW_S, NOISE_RAD_S, N = 0.01, 0.01, 20_000
CURVE = StaticCurve(np.array([-90.0, -10.0, 10.0, 90.0]), np.array([-8.0, 0.0, 0.0, 8.0]))
MODEL = HammersteinModel(
    first_order(0.0035, 0.0015, WINDOW_S),
    (OperatingPoint(None, None, CURVE, (-90.0, 90.0), (None, None), NOISE_RAD_S),),
    "test",
)


def _stretch(phase_deg: Array, *own: Applied) -> Stretch:
    n = phase_deg.size
    t_s = WINDOW_S * np.arange(1.0, n + 1.0)
    record = Record("run", t_s, phase_deg, np.zeros(n), np.full(n, WINDOW_S))
    (stretch,), _ = cut_runs([record], MODEL, own)
    return stretch


@pytest.fixture(scope="module")
def stretch() -> Stretch:
    rng = np.random.default_rng(1)
    return _stretch(np.repeat(rng.uniform(-89.0, 89.0, N // 10), 10))


@pytest.mark.parametrize("kind", range(4))
@pytest.mark.parametrize("grows", [False, True])
def test_what_steps_add_is_found_by_their_size(stretch: Stretch, kind: int, grows: bool) -> None:
    rng = np.random.default_rng(2)
    size = np.abs(stretch.step_rad_s)
    moved = (stretch.lag == 1) & (step_kind(stretch) == kind)
    added = np.where(moved, 0.05 * size if grows else 0.2, 0.0)
    level = np.hypot(NOISE_RAD_S, added)
    noise = estimate_noise([stretch], [level * rng.standard_normal(N)], [stretch.use])
    # At the curve's corners nobody knows where exactly the motor starts, whatever the noise.
    corner = np.abs(np.abs(stretch.context.phase_deg) - 10.0) < 2.0
    usual = moved & ~corner & (size > 1.0)
    assert np.median(noise.level_rad_s(stretch)[usual] / level[usual]) == pytest.approx(1, abs=0.15)
    calm = stretch.use & ~moved & ~corner
    assert np.median(noise.level_rad_s(stretch)[calm]) == pytest.approx(NOISE_RAD_S, rel=0.1)


def test_nobody_knows_when_a_step_takes_effect_that_is_larger_than_any_seen() -> None:
    rng = np.random.default_rng(6)
    small = _stretch(np.clip(np.repeat(np.cumsum(rng.choice([-4.0, 4.0], 2000)), 10), 20.0, 80.0))
    white = NOISE_RAD_S * rng.standard_normal(small.context.n)
    noise = estimate_noise([small], [white], [small.use])
    levels = noise.level_rad_s(_stretch(np.repeat([30.0, 34.0, 84.0, 84.0], 20)))
    assert levels[[20, 21, 22]] == pytest.approx(3 * [NOISE_RAD_S], rel=0.3)
    largest = np.quantile(np.abs(small.step_rad_s), 0.9)
    beyond = 5e-3 * (50.0 / 80.0 * 8.0 - 1.5 * largest)
    assert np.all(levels[[40, 41]] > 1.2 * beyond)
    assert levels[42] == pytest.approx(NOISE_RAD_S, rel=0.3)


def test_a_reversal_between_small_speeds_is_as_uncertain_as_between_larger_ones(
    stretch: Stretch,
) -> None:
    rng = np.random.default_rng(5)
    turned = (stretch.lag == 0) & (step_kind(stretch) == 3)
    level = np.where(turned, 0.2, NOISE_RAD_S)
    noise = estimate_noise([stretch], [level * rng.standard_normal(N)], [stretch.use])
    small = _stretch(np.repeat([80.0, 13.0, -13.0, 16.0, 60.0], 20))
    assert step_kind(small)[[40, 60]].tolist() == [3, 3]
    assert noise.level_rad_s(small)[[40, 60]] == pytest.approx([0.2, 0.2], rel=0.3)
    assert noise.level_rad_s(small)[80] == pytest.approx(NOISE_RAD_S, rel=0.3)


def test_a_larger_step_than_any_seen_adds_more_in_proportion(stretch: Stretch) -> None:
    rng = np.random.default_rng(3)
    level = np.where(stretch.lag == 0, 0.05 * np.abs(stretch.step_rad_s), NOISE_RAD_S)
    noise = estimate_noise([stretch], [level * rng.standard_normal(N)], [stretch.use])
    twice = replace(stretch, step_rad_s=20.0 * stretch.step_rad_s)
    row = int(np.argmax(np.abs(stretch.step_rad_s) * (stretch.lag == 0)))
    ratio = noise.level_rad_s(twice)[row] / noise.level_rad_s(stretch)[row]
    assert ratio == pytest.approx(20.0, rel=0.3)


def test_a_noise_comes_back_from_a_model_file(stretch: Stretch) -> None:
    residual = NOISE_RAD_S * np.random.default_rng(4).standard_normal(N)
    found = estimate_noise([stretch], [residual], [stretch.use])
    noise = replace(found, running_out=0.5)
    again = noise_from_mapping(noise.to_mapping())
    assert again.running_out == 0.5
    assert np.array_equal(again.level_rad_s(stretch), noise.level_rad_s(stretch))
    older = {key: kept for key, kept in noise.to_mapping().items() if key != "running_out"}
    assert noise_from_mapping(older).running_out == 0.0
