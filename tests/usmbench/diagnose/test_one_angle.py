"""Two runs of one disc that begin at other angles."""

import numpy as np
import pytest

from known_motor import applied, identified, measured
from usmbench.diagnose.cut_runs import cut_runs
from usmbench.diagnose.one_angle import at_one_angle
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return identified()


def _eccentric(seed: int, share: float, phase_rad: float) -> Record:
    cosine, sine = share * np.cos(phase_rad), share * np.sin(phase_rad)
    return measured(seed, applied("encoder_eccentricity", "", cosine=cosine, sine=sine))


@pytest.mark.parametrize("apart_rad", [1.2, 3.1, -2.0])
def test_a_disc_is_named_from_runs_that_begin_at_other_angles(
    model: HammersteinModel, apart_rad: float
) -> None:
    runs = [_eccentric(3, 0.012, 0.4), _eccentric(4, 0.012, 0.4 + apart_rad)]
    found = diagnose(runs, model)
    (cause,) = found.causes
    assert cause.name == "encoder_eccentricity"
    cosine, sine = (parameter.value for parameter in cause.parameters)
    assert np.hypot(cosine, sine) == pytest.approx(0.012, rel=0.1)
    assert any("begins anew in each run" in warning for warning in found.warnings)


@pytest.mark.parametrize("shares", [(0.0, 0.0), (0.012, 0.0), (0.012, 0.04)])
def test_runs_without_a_ripple_or_of_different_discs_stay_as_they_are(
    model: HammersteinModel, shares: tuple[float, float]
) -> None:
    runs = [_eccentric(seed, share, seed) for seed, share in enumerate(shares, start=3)]
    stretches, _ = cut_runs(runs, model, ())
    turned, warnings = at_one_angle(stretches)
    assert warnings == []
    for before, after in zip(stretches, turned, strict=True):
        assert np.array_equal(np.asarray(before.context.angle_rad), after.context.angle_rad)
