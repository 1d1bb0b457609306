"""Runs and models that nothing can be said of are refused, and named."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import identified, measured
from usmbench.diagnose.pipeline import diagnose
from usmbench.errors import InputError
from usmbench.model.hammerstein import HammersteinModel


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return identified()


def test_runs_of_two_motors(model: HammersteinModel) -> None:
    one, two = (replace(measured(k, n=500), meta={"motor": f"motor {k}"}) for k in (1, 2))
    with pytest.raises(InputError, match="do not belong together"):
        diagnose([one, two], model)


def test_a_run_too_short(model: HammersteinModel) -> None:
    with pytest.raises(InputError, match="measure at least"):
        diagnose([measured(3, n=40)], model)


def test_a_speed_that_is_no_number(model: HammersteinModel) -> None:
    record = measured(3, n=500)
    record.speed_rad_s[17] = np.nan
    with pytest.raises(InputError, match="row 17 is nan"):
        diagnose([record], model)


def test_a_run_outside_the_model(model: HammersteinModel) -> None:
    record = measured(3, n=500)
    with pytest.raises(InputError, match="outside"):
        diagnose([replace(record, phase_deg=record.phase_deg + 150.0)], model)


def test_other_windows(model: HammersteinModel) -> None:
    record = measured(3, n=500)
    slow = replace(record, window_s=2.0 * record.window_s, t_s=2.0 * record.t_s)
    with pytest.raises(InputError, match="windows of 20 ms"):
        diagnose([slow], model)


def test_a_shaft_that_hardly_turns_cannot_show_the_disc(model: HammersteinModel) -> None:
    record = measured(3, n=500)
    still = replace(record, phase_deg=np.zeros(500), speed_rad_s=np.zeros(500))
    found = diagnose([still], model)
    assert "encoder_eccentricity" in dict(found.not_testable)


def test_damaged_knowledge(model: HammersteinModel) -> None:
    broken = replace(model, residual={"diagnosis": {"noise": 3}})
    with pytest.raises(InputError, match="cannot be used"):
        diagnose([measured(3, n=500)], broken)


def test_knowledge_of_another_version(model: HammersteinModel) -> None:
    content = model.residual["diagnosis"]
    older = replace(model, residual={"diagnosis": {**content, "shapes": 1}})
    with pytest.raises(InputError, match=r"of another version\); identify the model again"):
        diagnose([measured(3, n=500)], older)
    other = replace(model, residual={"diagnosis": {**content, "mean": content["mean"][1:]}})
    with pytest.raises(InputError, match=r"shapes are not the \d+ of this version"):
        diagnose([measured(3, n=500)], other)


@pytest.mark.parametrize(
    ("part", "key", "value"),
    [
        ("noise", "phase_deg", []),
        ("noise", "step_spread_rad_s", [1.0]),
        ("noise", "same_again", [1.0, 2.0]),
        ("noise", "ar", [1.0, 2.0]),
        ("noise", "innovation", 0.0),
        ("features", "nodes_deg", [2.0, 1.0]),
        ("features", "unmeasured_rad_s", [1.0]),
    ],
)
def test_knowledge_of_another_shape(
    model: HammersteinModel, part: str, key: str, value: object
) -> None:
    content = model.residual["diagnosis"]
    broken = {**content, part: {**content[part], key: value}}
    with pytest.raises(InputError, match="cannot be used"):
        diagnose([measured(3, n=500)], replace(model, residual={"diagnosis": broken}))
