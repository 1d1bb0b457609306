"""What effects foretell of blocks that their fit has not seen."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.fitting.fit import NOTHING, Fit
from usmbench.diagnose.fitting.foretold import foretells_nothing, foretold_rad_s, held_out_drop
from usmbench.diagnose.known.knowledge import Knowledge
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.model.effects.registry import find_effect
from usmbench.model.hammerstein import HammersteinModel

Array = NDArray[np.float64]

NOISE_RAD_S = 0.02
LEAN = Applied(find_effect("gain_asymmetry", "balanced"), {"asymmetry": 0.003})


@pytest.fixture
def known(model: HammersteinModel) -> Knowledge:
    """Return what is known of a model that leaves ten times as much as the noise."""
    plain = knowledge_of(model)
    phases = np.array(plain.features.groups) == "phase"
    return replace(plain, mean=np.where(phases, 10.0 * NOISE_RAD_S, 0.0))


def problem_of(known: Knowledge, stretch: Stretch, left_rad_s: Array) -> Problem:
    """Return the problem of a run that leaves a residual beside a little noise."""
    noise_rad_s = NOISE_RAD_S * np.random.default_rng(1).standard_normal(stretch.context.n)
    (plain, left) = (
        replace(stretch, speed_rad_s=stretch.simulated_rad_s + noise_rad_s + more)
        for more in (0.0, left_rad_s)
    )
    noise = estimate_noise([plain], [plain.residual_rad_s], [plain.use])
    return Problem([left], known, noise, [left.use])


def change_rad_s(problem: Problem) -> Array:
    (change,) = problem.change_rad_s([LEAN])
    return change


@pytest.mark.parametrize("along", [-1.0, 0.0, 1.0])
def test_a_small_change_counts_beside_what_the_model_is_known_to_leave(
    stretches: list[Stretch], known: Knowledge, along: float
) -> None:
    (stretch,) = stretches
    expected = known.expected_rad_s(stretch)
    healthy = problem_of(known, stretch, expected)
    change = change_rad_s(healthy)
    known_along = replace(known, mean=along * known.mean)
    problem = problem_of(known_along, stretch, along * expected + change)
    assert np.linalg.norm(change) < 0.2 * np.linalg.norm(expected)
    assert not foretells_nothing(problem, [change])
    assert foretells_nothing(problem, [-5.0 * change])


def test_what_only_makes_up_for_what_is_expected_and_not_there_is_nothing(
    stretches: list[Stretch], known: Knowledge
) -> None:
    (stretch,) = stretches
    expected = known.expected_rad_s(stretch)
    problem = problem_of(known, stretch, 0.0 * expected)
    assert foretells_nothing(problem, [-expected])


def test_what_is_expected_may_hide_half_of_a_change(
    stretches: list[Stretch], known: Knowledge
) -> None:
    (stretch,) = stretches
    expected = known.expected_rad_s(stretch)
    problem = problem_of(known, stretch, -expected)
    assert not foretells_nothing(problem, [-2.0 * expected])


@pytest.mark.parametrize(("hum_rad_s", "nothing"), [(0.0, False), (0.3, True)])
def test_a_day_of_another_gain_is_not_what_a_small_change_has_to_touch(
    stretches: list[Stretch], known: Knowledge, hum_rad_s: float, nothing: bool
) -> None:
    (stretch,) = stretches
    wanders = replace(known, wander=replace(known.wander, gain=0.01), mean=0.0 * known.mean)
    change = change_rad_s(problem_of(wanders, stretch, np.zeros(stretch.context.n)))
    day = 0.017 * stretch.simulated_rad_s
    hum = hum_rad_s * np.sin(0.7 * np.arange(stretch.context.n))
    assert foretells_nothing(problem_of(wanders, stretch, change + day + hum), [change]) == nothing


@pytest.mark.parametrize(("day", "nothing"), [(-0.02, False), (0.02, False), (-0.04, True)])
def test_a_day_of_another_gain_may_lie_against_a_small_change(
    stretches: list[Stretch], known: Knowledge, day: float, nothing: bool
) -> None:
    """Though it hides what the model is expected to leave, as far as such days are likely."""
    (stretch,) = stretches
    wanders = replace(known, wander=replace(known.wander, gain=0.01))
    change = change_rad_s(problem_of(wanders, stretch, np.zeros(stretch.context.n)))
    problem = problem_of(wanders, stretch, change + day * stretch.simulated_rad_s)
    assert foretells_nothing(problem, [change]) == nothing


def test_what_makes_the_simulation_plainly_worse_is_nothing(
    stretches: list[Stretch], known: Knowledge
) -> None:
    """Though a day's gain might be what hides it."""
    (stretch,) = stretches
    wide = replace(known, wander=replace(known.wander, gain=0.05))
    problem = problem_of(wide, stretch, known.expected_rad_s(stretch))
    level = float(np.sqrt(np.mean(stretch.simulated_rad_s[stretch.use] ** 2)))
    noisy = float(np.sqrt(np.mean(problem.stretches[0].residual_rad_s[stretch.use] ** 2)))
    gain = (noisy / level) * stretch.simulated_rad_s
    sign = -np.sign(gain @ problem.stretches[0].residual_rad_s)
    assert foretells_nothing(problem, [sign * gain])
    assert not foretells_nothing(problem, [0.1 * sign * gain])


@pytest.mark.parametrize(("wander", "nothing"), [(0.02, False), (0.004, True)])
def test_what_is_sure_may_be_hidden_by_a_day_that_is_not_rare(
    stretches: list[Stretch], known: Knowledge, wander: float, nothing: bool
) -> None:
    """A drag that a motor which is faster by 2 % makes up for."""
    (stretch,) = stretches
    another = replace(known, wander=replace(known.wander, gain=wander))
    drag = -0.1 * np.sign(stretch.simulated_rad_s)
    faster = 0.02 * stretch.simulated_rad_s
    problem = problem_of(another, stretch, known.expected_rad_s(stretch) + faster + drag)
    assert foretells_nothing(problem, [drag])
    assert foretells_nothing(problem, [drag], sure=True) == nothing


@pytest.mark.parametrize(("share", "nothing"), [(0.02, True), (1.0, False)])
def test_of_what_is_plainly_wrong_a_tenth_has_to_go(
    stretches: list[Stretch], known: Knowledge, share: float, nothing: bool
) -> None:
    (stretch,) = stretches
    hum = 0.3 * np.sin(0.7 * np.arange(stretch.context.n))
    problem = problem_of(known.nothing, stretch, hum)
    assert foretells_nothing(problem, [share * hum]) == nothing


def test_each_block_is_foretold_from_the_others(stretches: list[Stretch], known: Knowledge) -> None:
    (stretch,) = stretches
    change = change_rad_s(problem_of(known.nothing, stretch, np.zeros(stretch.context.n)))
    problem = problem_of(known.nothing, stretch, 10.0 * change)
    (foretold,) = foretold_rad_s(problem, Fit((LEAN,), 0.0, 0.0))
    used = problem.stretches[0].use
    assert foretold[used] == pytest.approx(10.0 * change[used], abs=0.05)
    assert np.sum(held_out_drop(problem, Fit((LEAN,), 0.0, 0.0))) > 10.0
    assert not np.any(foretold_rad_s(problem, NOTHING)[0])


def test_nothing_is_foretold_where_too_few_rows_are_left_to_fit(
    stretches: list[Stretch], known: Knowledge
) -> None:
    (stretch,) = stretches
    change = change_rad_s(problem_of(known, stretch, np.zeros(stretch.context.n)))
    problem = problem_of(known, stretch, change)
    fit = Fit((LEAN,), problem.drop([LEAN]), 0.0)
    # Within two of twelve blocks: without the one, nothing of the other is left to fit.
    first = [stretch.use & (np.arange(stretch.context.n) < 30)]
    assert np.all(held_out_drop(problem.with_masks(first), fit)[:2] == 0.0)
    assert np.any(foretold_rad_s(problem, fit)[0] != 0.0)
    assert np.all(foretold_rad_s(problem.with_masks(first), fit)[0][:32] == 0.0)
