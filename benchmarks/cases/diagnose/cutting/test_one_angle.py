"""Two runs of one disc that begin at other angles."""

import numpy as np
import pytest

from known_motor import applied, eccentric, measured
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.hammerstein import HammersteinModel


def test_a_disc_is_seen_beside_a_direction_that_is_faster(model: HammersteinModel) -> None:
    disc = (applied("encoder_eccentricity", "", cosine=0.02, sine=0.0),)
    elsewhere = (applied("encoder_eccentricity", "", cosine=0.0, sine=0.02),)
    faster = applied("gain_asymmetry", "forwards", gain=-0.035)
    runs = [measured(3, *disc, faster), measured(4, *elsewhere, faster)]
    found = diagnose(runs, model)
    assert {cause.name for cause in found.causes} == {"gain_asymmetry", "encoder_eccentricity"}
    assert found.verdict == "explained"
    assert any("begins anew in each run" in warning for warning in found.warnings)


def test_an_extended_model_knows_its_ripple_in_a_run_that_begins_elsewhere(
    model: HammersteinModel,
) -> None:
    extended = diagnose([eccentric(3, 0.012, 0.4)], model).extended
    again = diagnose([eccentric(5, 0.012, 2.9)], extended)
    assert again.verdict == "no_discrepancy"
    assert any("begins elsewhere" in warning for warning in again.warnings)
    larger = diagnose([eccentric(6, 0.02, 1.0)], extended)
    assert [cause.name for cause in larger.causes] == ["encoder_eccentricity"]


def test_a_disc_is_named_from_runs_that_begin_at_other_angles(model: HammersteinModel) -> None:
    runs = [eccentric(3, 0.012, 0.4), eccentric(4, 0.012, 3.5)]
    found = diagnose(runs, model)
    (cause,) = found.causes
    assert cause.name == "encoder_eccentricity"
    cosine, sine = (parameter.value for parameter in cause.parameters)
    assert np.hypot(cosine, sine) == pytest.approx(0.012, rel=0.1)
    assert any("begins anew in each run" in warning for warning in found.warnings)
