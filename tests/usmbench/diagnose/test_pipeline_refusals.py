"""Runs and models that nothing can be said of are refused, and named."""

import copy
from dataclasses import replace

import numpy as np
import pytest

from known_motor import driven, identified, measured
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
    broken = replace(model, residual={"diagnosis": {"noise": 3}}, name="bad.yaml")
    with pytest.raises(InputError, match=r"^bad.yaml \(residual.diagnosis\): noise: 3 is not a ma"):
        diagnose([measured(3, n=500)], broken)


def test_knowledge_of_another_version(model: HammersteinModel) -> None:
    content = model.residual["diagnosis"]
    older = replace(model, residual={"diagnosis": {**content, "shapes": 1}})
    with pytest.raises(InputError, match="of another version; identify the model again"):
        diagnose([measured(3, n=500)], older)
    other = replace(model, residual={"diagnosis": {**content, "mean": content["mean"][1:]}})
    with pytest.raises(InputError, match=r"shapes are not the \d+ of this version; identify"):
        diagnose([measured(3, n=500)], other)


@pytest.mark.parametrize(
    ("part", "key", "value", "says"),
    [
        ("noise", "phase_deg", [], "noise.phase_deg: has 0 entries"),
        ("noise", "sigma_rad_s", [0] * 20, r"noise.sigma_rad_s\[0\]: 0 is not above 0"),
        ("noise", "sigma_rad_s", [-1.0], r"noise.sigma_rad_s\[0\]: -1.0 is not above 0"),
        ("noise", "sigma_rad_s", [np.nan], r"noise.sigma_rad_s\[0\]: nan is not a number"),
        ("noise", "sigma_rad_s", [1.0], r"noise.sigma_rad_s has not the shape \(\d+,\); identify"),
        ("noise", "step_spread_rad_s", [1.0], r"step_spread_rad_s\[0\]: 1.0 is not a list"),
        ("noise", "step_rad_s", [[[1.0], [2.0, 3.0]]], "step_rad_s has rows of different lengths"),
        ("noise", "same_again", [1.0, 0.5], "noise.same_again has not the shape"),
        ("noise", "ar", [1.0, 2.0], "noise.ar is no noise: it grows without end; identify"),
        ("noise", "ar", 101 * [0.0], "noise.ar: has 101 entries; give at most 100"),
        ("noise", "innovation", 0.0, "noise.innovation: 0.0 is not above 0"),
        ("features", "nodes_deg", [2.0, 1.0], "features.nodes_deg does not rise; identify"),
        ("features", "unmeasured_rad_s", [1.0], "features.unmeasured_rad_s has not one value a"),
        ("features", "n_constants", 10**11, "features.n_constants: 100000000000 is above 5"),
        ("features", "n_points", 10**6, "features.n_points is 1000000, the model's points are 1;"),
        ("features", "top_rad_s", 0, "features.top_rad_s: 0 is not above 0"),
        ("", "gain_tilt", [], "gain_tilt has not 1 values"),
        ("", "held_back_rad_s", [1e-3, 1e-3], "held_back_rad_s has not 1 values"),
        ("", "late_s", "many", "late_s: 'many' is not a number"),
        ("", "covariance_root", "A", r"covariance_root is no triangle of \d+ rows of numbers;"),
        ("", "habits", [{"name": "gremlins"}], "'gremlins' .* is not installed"),
    ],
)
def test_knowledge_that_cannot_be(
    model: HammersteinModel, part: str, key: str, value: object, says: str
) -> None:
    content = copy.deepcopy(model.residual["diagnosis"])
    (content[part] if part else content)[key] = value
    with pytest.raises(InputError, match=rf"^the model \(residual.diagnosis\): .*{says}"):
        diagnose([measured(3, n=500)], replace(model, residual={"diagnosis": content}))


def test_noise_at_phases_that_do_not_rise(model: HammersteinModel) -> None:
    content = copy.deepcopy(model.residual["diagnosis"])
    content["noise"]["phase_deg"].reverse()
    with pytest.raises(InputError, match=r"noise\.phase_deg does not rise; identify"):
        diagnose([measured(3, n=500)], replace(model, residual={"diagnosis": content}))


def test_a_run_in_which_nothing_moves_is_refused(model: HammersteinModel) -> None:
    still = replace(measured(7), speed_rad_s=np.zeros(measured(7).t_s.size))
    with pytest.raises(InputError, match="the speed is 0 throughout where the model turns"):
        diagnose([still], model)
    still.speed_rad_s[100] = 0.3  # a stray count
    with pytest.raises(InputError, match="the speed is 0 throughout where the model turns"):
        diagnose([still], model)
    still.speed_rad_s[::40] = 0.3  # a channel that is dead
    with pytest.raises(InputError, match="the speed is 0 throughout where the model turns"):
        diagnose([still], model)
    still.speed_rad_s[:] = 0.0
    at_rest = replace(still, phase_deg=np.zeros(still.t_s.size))
    assert diagnose([at_rest], model).verdict == "no_discrepancy"


def test_a_speed_that_is_the_same_whatever_the_phase_is_refused(model: HammersteinModel) -> None:
    frozen = replace(measured(7), speed_rad_s=np.full(measured(7).t_s.size, 5.0))
    with pytest.raises(InputError, match="is 5 rad/s throughout whatever the phase"):
        diagnose([frozen], model)
    held = driven(np.full(600, 60.0), 7)
    same = replace(held, speed_rad_s=np.full(600, float(np.mean(held.speed_rad_s))))
    assert diagnose([same], model).n_windows > 0


def test_a_run_that_was_not_driven_is_refused(model: HammersteinModel) -> None:
    run = measured(7)
    off = replace(run, extra={"drive_on": np.zeros(run.t_s.size)})
    with pytest.raises(InputError, match="the drive was off in every window"):
        diagnose([off], model)
    run = replace(run, extra={"drive_on": np.r_[np.zeros(100), np.ones(run.t_s.size - 100)]})
    diagnose([run], model)
