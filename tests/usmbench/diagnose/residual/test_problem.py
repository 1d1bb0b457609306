"""A residual weighs what its covariance says."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.knowledge import Knowledge
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.naming.ranking import NO_CHANCE
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.noise.noise_model import Noise
from usmbench.diagnose.noise.whitening import memory_rows, whitening
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.whole import excused
from usmbench.model.applied import Applied
from usmbench.model.effects.registry import find_effect
from usmbench.model.hammerstein import HammersteinModel

Array = NDArray[np.float64]

FEEDBACK, INNOVATION = 0.6, 0.8


@pytest.fixture
def known(model: HammersteinModel) -> Knowledge:
    """Return what is known, with ways to differ in which shapes differ together."""
    plain = knowledge_of(model)
    together = np.random.default_rng(3).standard_normal(plain.root.shape)
    return replace(plain, root=plain.root @ together)


@pytest.fixture
def noise(stretches: list[Stretch]) -> Noise:
    """Return a coloured noise."""
    left, uses = [s.residual_rad_s for s in stretches], [s.use for s in stretches]
    rough = estimate_noise(stretches, left, uses)
    return replace(rough, ar=np.array([FEEDBACK]), innovation=INNOVATION)


def deviance(white: Array, free: Array) -> float:
    """Return the deviance of a whitened residual that may differ along columns."""
    return float(white @ np.linalg.solve(np.eye(white.size) + free @ free.T, white))


def test_rows_may_be_off_as_the_covariance_says(
    stretches: list[Stretch], known: Knowledge, noise: Noise
) -> None:
    problem = Problem(stretches, known, noise, [s.use for s in stretches])
    rows = [s.use & (s.lag > 0) for s in stretches]
    shapes, root = known.background(stretches)
    for unsure, mask, own in zip(problem.unsure_rad_s(rows), rows, shapes, strict=True):
        covariance = own @ root @ root.T @ own.T
        assert unsure[mask] == pytest.approx(np.sqrt(np.diag(covariance))[mask])
        assert not unsure[~mask].any()


def test_the_deviance_is_that_of_the_whole_covariance(
    stretches: list[Stretch], known: Knowledge, noise: Noise, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("usmbench.diagnose.residual.carrier._HIDDEN", 0.0)
    use = stretches[0].use.copy()
    use[120:123] = False
    problem = Problem(stretches, known, noise, [use])
    counts = [all(use[max(k - memory_rows(noise), 0) : k + 1]) for k in range(use.size)]
    assert problem.n_rows == np.count_nonzero(counts)
    (shapes,), root = known.background(stretches)
    white = whitening(noise, stretches[0]).toarray()[counts]
    error, free = white @ problem.residual_rad_s[0], white @ (shapes @ root)
    assert problem.deviance == pytest.approx(deviance(error, free), rel=1e-6)
    assert problem.deviance < 0.9 * float(error @ error)
    twice = problem.weighed(noise, [use], [np.full(use.size, 2.0)])
    assert twice.deviance == pytest.approx(deviance(2.0 * error, 2.0 * free), rel=1e-6)


def test_what_is_no_news_departs_by_its_deviations_and_beyond_them_it_hides_something(
    stretches: list[Stretch], known: Knowledge, noise: Noise
) -> None:
    (stretch,) = stretches
    problem = Problem(stretches, known, noise, [stretch.use])
    (shapes,), root = known.background(stretches)
    rng = np.random.default_rng(5)
    noisy = np.linalg.inv(whitening(noise, stretch).toarray())

    def left_rad_s(deviations: float) -> Array:
        departs = deviations * (root @ rng.standard_normal(root.shape[1]))
        return np.asarray(shapes @ departs + noisy @ rng.standard_normal(stretch.context.n))

    healthy = [problem.measuring([left_rad_s(1.0)]) for _ in range(40)]
    assert np.mean([np.mean(p.excuses()[0] ** 2) for p in healthy]) == pytest.approx(1.0, abs=0.15)
    assert min(excused(p, 1.0).p_value for p in healthy) > NO_CHANCE
    assert excused(problem.measuring([left_rad_s(6.0)]), 1.0).p_value < 1e-9


def test_several_residuals_weigh_together_what_each_weighs(
    stretches: list[Stretch], known: Knowledge, noise: Noise
) -> None:
    problem = Problem(stretches, known, noise, [s.use for s in stretches])
    signals = np.random.default_rng(1).standard_normal((stretches[0].context.n, 3))
    together = problem.carried([signals])
    for column, signal in zip(together.T, signals.T, strict=True):
        np.testing.assert_allclose(column, problem.carried([signal]), atol=1e-9)


def test_products_are_those_of_carried_residuals(
    stretches: list[Stretch], known: Knowledge, noise: Noise
) -> None:
    twice = [stretches[0], stretches[0]]
    problem = Problem(twice, known, noise, [s.use for s in twice])
    rng = np.random.default_rng(1)
    signals = [[rng.standard_normal(s.context.n) for s in twice] for _ in range(3)]
    carried = np.array([problem.carried(signal) for signal in signals])
    joined = np.column_stack([np.concatenate(signal) for signal in signals])
    pulled = problem.pulled(joined)
    np.testing.assert_allclose(pulled.products(pulled), carried @ carried.T, atol=1e-8)
    np.testing.assert_allclose(pulled.one(1).products(pulled), carried[1:2] @ carried.T, atol=1e-8)


def test_a_problem_weighed_anew_is_one_made_anew(
    stretches: list[Stretch], known: Knowledge, noise: Noise
) -> None:
    uses = [s.use for s in stretches]
    late = [Applied(find_effect("transport_delay", ""), {"delay_s": 0.004})]
    white = replace(noise, ar=np.empty(0), innovation=1.0)
    problem = Problem(stretches, known, white, uses)
    before = problem.left(late)
    anew = problem.weighed(noise, uses)
    np.testing.assert_array_equal(
        anew.left(late), Problem(stretches, known, noise, uses).left(late)
    )
    np.testing.assert_array_equal(problem.left(late), before)


LATE = Applied(find_effect("transport_delay", ""), {"delay_s": 0.004})
LEAN = Applied(find_effect("gain_asymmetry", "balanced"), {"asymmetry": 0.3})


def test_what_may_be_there_by_any_size_costs_nothing(
    stretches: list[Stretch], known: Knowledge, noise: Noise
) -> None:
    problem = Problem(stretches, known, noise, [s.use for s in stretches])
    free = problem.freeing([LATE])
    shares = []
    for effect in (LATE, LEAN):
        signal = [3.0 * change for change in problem.change_rad_s([effect])]
        before, after = (float(np.sum(p.carried(signal) ** 2)) for p in (problem, free))
        shares.append(after / before)
    assert shares[0] < 1e-4
    assert shares[1] > 0.5


def test_another_gain_makes_as_much_more_of_an_effect(
    stretches: list[Stretch], model: HammersteinModel, noise: Noise
) -> None:
    plain = knowledge_of(model).nothing
    known = replace(plain, wander=replace(plain.wander, gain=0.02))
    problem = Problem(stretches, known, noise, [s.use for s in stretches])
    (change,) = problem.change_rad_s([LEAN])
    signal = [0.02 * (stretches[0].simulated_rad_s + change)]
    leaning = problem.showing([LEAN])
    before, after = (float(np.sum(p.carried(signal) ** 2)) for p in (problem, leaning))
    assert after <= 1.0 + 1e-6  # one standard deviation of what is no news
    assert before > 5.0
    again = leaning.showing(())
    np.testing.assert_allclose(again.carried(signal), problem.carried(signal), atol=1e-9)


@pytest.mark.parametrize(
    "counter",
    [
        Applied(find_effect("swapped_channels", ""), {}),
        Applied(find_effect("speed_scale", ""), {"scale_error": -0.5}),
    ],
    ids=lambda counter: counter.effect.name,
)
def test_a_counter_does_to_what_the_model_is_off_by_what_it_does_to_the_speed(
    counter: Applied, model: HammersteinModel, stretches: list[Stretch], noise: Noise
) -> None:
    plain = knowledge_of(model)
    rough = np.where(np.array(plain.features.groups) == "phase", 0.1, 0.0)
    known = replace(plain, mean=rough * np.random.default_rng(2).standard_normal(rough.size))
    (stretch,) = stretches
    shaft_rad_s = stretch.simulated_rad_s + known.expected_rad_s(stretch)
    reported = counter.effect.apply(shaft_rad_s, stretch.context, counter.values)
    problem = Problem([replace(stretch, speed_rad_s=reported)], known, noise, [stretch.use])
    plainly, shown = (p.left_rad_s([counter])[0] for p in (problem, problem.showing([counter])))
    assert np.max(np.abs(shown)) < 1e-9
    assert np.max(np.abs(plainly)) > 0.05


def test_what_the_curve_is_known_to_be_off_by_belongs_to_the_phases_that_are_set(
    model: HammersteinModel, stretches: list[Stretch], noise: Noise
) -> None:
    plain = knowledge_of(model)
    rough = np.where(np.array(plain.features.groups) == "phase", 0.1, 0.0)
    known = replace(plain, mean=rough * np.random.default_rng(2).standard_normal(rough.size))
    offset = Applied(find_effect("phase_offset", ""), {"offset_deg": 4.0})
    (stretch,) = stretches
    moved = replace(
        stretch, context=replace(stretch.context, phase_deg=stretch.context.phase_deg + 4.0)
    )
    (change,) = Problem(stretches, known, noise, [stretch.use]).change_rad_s([offset])
    off = known.expected_rad_s(replace(moved, simulated_rad_s=stretch.simulated_rad_s + change))
    offset_motor = replace(stretch, speed_rad_s=stretch.simulated_rad_s + change + off)
    problem = Problem([offset_motor], known, noise, [stretch.use])
    plainly, shown = (p.left_rad_s([offset])[0] for p in (problem, problem.showing([offset])))
    assert np.max(np.abs(shown)) < 1e-9
    assert np.max(np.abs(plainly)) > 0.05
    (again,) = problem.showing([offset]).showing([]).residual_rad_s
    assert again == pytest.approx(problem.residual_rad_s[0])


def test_what_chance_does_comes_on_top_of_what_scatters_anyhow(
    stretches: list[Stretch], known: Knowledge, noise: Noise
) -> None:
    lost = Applied(
        find_effect("missed_counts", "of the excess"), {"lost_of_excess": 0.6, "above_rad_s": 3.5}
    )
    scattering = [replace(s, scatter_rad_s=0.1) for s in stretches]
    problem = Problem(scattering, known, noise, [s.use for s in stretches])
    for s in problem.scattering([lost], [lost]).stretches:
        assert np.min(s.scatter_rad_s) == pytest.approx(0.1)
        assert np.max(s.scatter_rad_s) > 0.1
