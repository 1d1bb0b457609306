"""Two runs of one disc that begin at other angles."""

import numpy as np
import pytest

from known_motor import applied, driven, eccentric, identified, measured
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.one_angle import at_one_angle
from usmbench.model.hammerstein import HammersteinModel


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return identified()


@pytest.mark.parametrize("n", [300, 1000])
def test_a_short_run_whose_phase_glides_is_shifted_to_a_long_one(
    model: HammersteinModel, n: int
) -> None:
    gliding_deg = 88.0 * np.sin(2.0 * np.pi * np.arange(n) / 200.0)
    disc = applied("encoder_eccentricity", "", cosine=0.012 * np.cos(2.6), sine=0.012 * np.sin(2.6))
    runs = [eccentric(3, 0.012, 0.4), driven(gliding_deg, 4, disc)]
    stretches, _ = cut_runs(runs, model, ())
    turned, warnings = at_one_angle(stretches)
    assert len(warnings) == 1
    by_rad = [
        float(np.mean(after.context.angle_rad - before.context.angle_rad))
        for before, after in zip(stretches, turned, strict=True)
        if after.context.angle_rad is not None and before.context.angle_rad is not None
    ]
    assert by_rad[1] - by_rad[0] == pytest.approx(0.4 - 2.6, abs=0.3)


def test_what_another_effect_leaves_is_no_ripple(model: HammersteinModel) -> None:
    slow = applied("slow_dynamics", "", added_s=0.02)
    for seed in range(3, 9):
        stretches, _ = cut_runs([measured(seed, slow), measured(seed + 10, slow)], model, ())
        assert at_one_angle(stretches)[1] == []


@pytest.mark.parametrize("shares", [(0.0, 0.0), (0.012, 0.0), (0.012, 0.04)])
def test_runs_without_a_ripple_or_of_different_discs_stay_as_they_are(
    model: HammersteinModel, shares: tuple[float, float]
) -> None:
    runs = [eccentric(seed, share, seed) for seed, share in enumerate(shares, start=3)]
    stretches, _ = cut_runs(runs, model, ())
    turned, warnings = at_one_angle(stretches)
    assert warnings == []
    for before, after in zip(stretches, turned, strict=True):
        assert after.context is before.context


def test_runs_that_begin_alike_stay_as_they_are(model: HammersteinModel) -> None:
    stretches, _ = cut_runs([eccentric(seed, 0.012, 0.4) for seed in (3, 4)], model, ())
    turned, warnings = at_one_angle(stretches)
    assert warnings == []
    for before, after in zip(stretches, turned, strict=True):
        assert after.context is before.context
