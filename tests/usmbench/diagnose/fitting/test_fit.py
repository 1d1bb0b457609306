"""What a statistic is worth where nothing is wrong."""

import numpy as np
import pytest
from scipy.stats import chi2

from usmbench.diagnose.fitting.fit import Fit
from usmbench.model.applied import Applied
from usmbench.model.effects.registry import find_effect


@pytest.mark.parametrize(
    ("name", "form", "sides"),
    [("phase_offset", "", 1.0), ("generator_imbalance", "along the resonance", 0.5)],
    ids=["either way", "one way"],
)
def test_chance_takes_a_statistic_as_often_as_its_p_value_says(
    name: str, form: str, sides: float
) -> None:
    effect = find_effect(name, form)
    (parameter,) = effect.parameters
    assert parameter.one_way == (sides < 1.0)
    slopes = np.random.default_rng(1).standard_normal(1_000_000)
    statistics = np.where((slopes > 0.0) | (sides == 1.0), slopes**2, 0.0)
    applied = Applied(effect, {parameter.name: parameter.null})
    for level in (1.0, 3.0, 6.0):
        p_value = Fit((applied,), level, 0.0).p_value
        assert p_value == pytest.approx(sides * chi2.sf(level, 1))
        assert np.mean(statistics > level) == pytest.approx(p_value, rel=0.03)
    assert Fit((applied,), 0.0, 0.0).p_value == 1.0


@pytest.mark.parametrize("form", [("phase_offset", ""), ("generator_imbalance", "")])
@pytest.mark.parametrize("roughness", [0.0, 3.0, 300.0])
def test_a_search_is_paid_for_with_what_it_makes_of_chance(
    form: tuple[str, str], roughness: float
) -> None:
    applied = Applied(find_effect(*form), {})
    fit, alone = (Fit((applied,), 60.0, rough) for rough in (roughness, 0.0))
    paid = 2.0 * np.log(fit.p_value / alone.p_value)
    assert fit.searched == pytest.approx(paid, rel=0.01, abs=1e-12)
    assert Fit((applied,), 1e7, roughness).searched >= fit.searched


@pytest.mark.parametrize(
    "form", [("thermal_drift", "speed"), ("thermal_drift", "speed and friction")]
)
def test_chance_takes_the_best_of_a_scan_as_often_as_its_p_value_says(
    form: tuple[str, str],
) -> None:
    applied = Applied(find_effect(*form), {})
    n_sizes = len(Fit((applied,), 0.0, 0.0).sized)
    scanned = np.linspace(0.0, 2.0, 41)  # a shape that turns by 2 rad, for each size in a plane
    draws = np.random.default_rng(1).standard_normal((2, n_sizes, 100_000, 1))
    along = draws[0] * np.cos(scanned) + draws[1] * np.sin(scanned)
    best = np.max(np.sum(along**2, axis=0), axis=1)
    for level in (6.0, 10.0):
        p_value = Fit((applied,), level, 2.0).p_value
        assert np.mean(best > level) == pytest.approx(p_value, rel=0.15)
