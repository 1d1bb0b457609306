"""A motor known to the last figure, an effect put into its runs, and what diagnose says."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from known_motor import applied, driven, identified, measured, wandering
from tests.usmbench.diagnose.hidden_effect import assert_named
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.applied import Applied
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.model_file import read_model, write_model


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return identified()


def test_finds_nothing_where_nothing_is(model: HammersteinModel) -> None:
    found = diagnose([measured(5)], model)
    assert found.verdict == "no_discrepancy"
    assert found.causes == ()
    assert found.extended == model
    sizes = {d.cause: d.value for d in found.minimum_detectable}
    assert sizes["gain_asymmetry"] is not None
    assert 0.0 < sizes["gain_asymmetry"] < 0.05


@pytest.mark.parametrize(("scale_error", "said"), [(0.0, False), (0.015, True)])
def test_says_that_what_is_left_is_no_more_than_days_differ_by(
    scale_error: float, *, said: bool
) -> None:
    record = measured(40, applied("speed_scale", "", scale_error=scale_error))
    found = diagnose([record], wandering())
    assert found.verdict == "no_discrepancy"
    assert said == any("are left where the noise is" in warning for warning in found.warnings)


@pytest.mark.parametrize(
    ("hidden", "parameter"),
    [
        (applied("gain_asymmetry", "balanced", asymmetry=0.04), "asymmetry"),
        (applied("transport_delay", "", delay_s=0.004), "delay_s"),
        (applied("swapped_channels", ""), None),
        (applied("phase_quantisation", "cut to zero", step_deg=0.9), "step_deg"),
    ],
    ids=lambda value: value.effect.name if isinstance(value, Applied) else "",
)
def test_names_what_was_hidden(
    model: HammersteinModel, hidden: Applied, parameter: str | None
) -> None:
    assert_named(model, hidden, parameter)


def test_what_one_run_cannot_show_is_said(model: HammersteinModel) -> None:
    of_one = replace(model, fitted_on=model.fitted_on[:1])
    found = diagnose([measured(7, applied("speed_scale", "", scale_error=0.03))], of_one)
    assert found.verdict == "explained"
    assert any("identified on one run" in warning for warning in found.warnings)


def test_phases_that_no_reference_drove_are_told() -> None:
    levels_deg = np.array([-80.0, -30.0, 20.0, 70.0])
    rng = np.random.default_rng(4)
    references = [driven(np.repeat(rng.choice(levels_deg, 120), 15), k) for k in (1, 2)]
    model = with_knowledge(identify_fast(references, FastOptions()).model, references)
    same = driven(np.repeat(rng.choice(levels_deg, 120), 15), 3)
    assert not any("the model may be off" in words for words in diagnose([same], model).warnings)
    others = driven(np.repeat(rng.uniform(-70.0, 60.0, 120), 15), 3)
    assert any("the model may be off" in words for words in diagnose([others], model).warnings)


def test_what_is_known_comes_back_from_the_model_file(
    model: HammersteinModel, tmp_path: Path
) -> None:
    write_model(tmp_path / "model.yaml", model)
    again = read_model(tmp_path / "model.yaml")
    assert again.residual["diagnosis"] == model.residual["diagnosis"]


@pytest.mark.parametrize(
    "phases_deg", [[0.0], [60.0], [40.0, 40.0, 80.0, 80.0], [20.0, 80.0, 50.0]]
)
def test_a_healthy_run_of_hardly_any_phases_is_judged(
    model: HammersteinModel, phases_deg: list[float]
) -> None:
    record = driven(np.tile(phases_deg, 1200 // len(phases_deg)), 5)
    assert diagnose([record], model).causes == ()


def test_an_angle_that_is_none_is_not_believed(model: HammersteinModel) -> None:
    record = measured(7, applied("encoder_eccentricity", "", cosine=0.03, sine=0.01))
    found = diagnose([replace(record, angle_rad=np.zeros(record.t_s.size))], model)
    assert [cause.name for cause in found.causes] == ["encoder_eccentricity"]
    assert any("angle_rad does not turn as speed_rad_s says" in w for w in found.warnings)
