"""What diagnose has no name for, or refuses to name: better none than a wrong one."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from known_motor import NOISE_RAD_S, WINDOW_S, applied, driven, measured
from usmbench.diagnose import held
from usmbench.diagnose.naming import stepwise, verdict
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.hammerstein import HammersteinModel


@pytest.mark.parametrize("share", [-0.03, 0.05])
def test_a_gain_that_steps_in_the_middle_of_a_run_is_left_over_in_time(
    model: HammersteinModel, share: float
) -> None:
    run = measured(7)
    late = run.t_s > 0.6 * run.t_s[-1]
    stepped = replace(run, speed_rad_s=run.speed_rad_s * np.where(late, 1.0 + share, 1.0))
    found = diagnose([stepped], model)
    assert (found.verdict, found.causes) == ("unexplained", ())
    assert found.remainder is not None
    assert found.remainder.versus == "time"
    assert "along the motion" in found.remainder.says


def test_a_cause_that_explains_nothing_of_unseen_blocks_is_not_named(
    model: HammersteinModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = measured(7, applied("gain_asymmetry", "balanced", asymmetry=0.04))
    assert diagnose([record], model).causes
    monkeypatch.setattr(stepwise, "held_out_drop", lambda *_: np.zeros(4))
    found = diagnose([record], model)
    assert found.verdict == "unexplained"
    assert found.causes == ()
    assert found.extended == model
    assert found.gain == 0.0


@pytest.mark.parametrize(("swing", "named"), [(0.0, ["load_torque"]), (0.5, [])])
def test_what_looks_like_a_weight_and_swings_with_the_angle_has_no_name(
    model: HammersteinModel, swing: float, named: list[str]
) -> None:
    record = measured(23)
    loaded = measured(23, applied("load_torque", "weight", one_sided_rad_s=0.15))
    angle_rad = WINDOW_S * np.cumsum(record.speed_rad_s)
    share = 1.0 + swing * np.sin(0.3 * angle_rad)
    speed_rad_s = record.speed_rad_s + share * (loaded.speed_rad_s - record.speed_rad_s)
    found = diagnose([replace(record, speed_rad_s=speed_rad_s)], model)
    assert [cause.name for cause in found.causes] == named
    assert found.verdict == ("explained" if named else "unexplained")


def test_friction_at_one_speed_is_no_loss_of_counts(model: HammersteinModel) -> None:
    record = measured(25)
    slower = 0.2 * np.exp(-((np.abs(record.speed_rad_s) - 5.0) ** 2))
    sung = record.speed_rad_s - slower * np.sign(record.speed_rad_s)
    assert diagnose([replace(record, speed_rad_s=sung)], model).verdict == "unexplained"


def test_a_ripple_faster_than_a_window_is_no_swinging_load(model: HammersteinModel) -> None:
    rng = np.random.default_rng(8)
    record = driven(np.repeat(rng.uniform(-88.0, 88.0, 100), 20), 8)
    ripple = 0.06 * np.sin(0.86 * np.arange(2000)) * (np.abs(record.speed_rad_s) > 0.3)
    found = diagnose([replace(record, speed_rad_s=record.speed_rad_s + ripple)], model)
    assert found.verdict == "unexplained"


@pytest.mark.parametrize("over", [3, 5])
def test_an_average_over_several_windows_is_no_ringing_as_damped_as_is_tried(
    model: HammersteinModel, over: int
) -> None:
    record = measured(26)
    averaged = lfilter(np.full(over, 1.0 / over), np.ones(1), record.speed_rad_s)
    found = diagnose([replace(record, speed_rad_s=averaged)], model)
    assert (found.verdict, found.causes) == ("unexplained", ())


_THREE = (
    applied("gain_asymmetry", "balanced", asymmetry=0.03),
    applied("transport_delay", "", delay_s=0.003),
    applied("phase_quantisation", "rounded", step_deg=5.0),
)


def test_three_causes_at_once_have_no_name(
    model: HammersteinModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = measured(11, *_THREE)
    found = diagnose([record], model)
    assert (found.verdict, found.causes) == ("unexplained", ())
    assert found.extended == model
    monkeypatch.setattr(verdict, "_MOST_NAMED", 3)
    assert {c.name for c in diagnose([record], model).causes} == {a.effect.name for a in _THREE}


@pytest.mark.parametrize(
    ("offset_deg", "says", "named"),
    [(0.05, "partly_explained", ["encoder_eccentricity"]), (0.5, "unexplained", [])],
)
def test_a_cause_stands_without_a_trifle_that_leaves_something_too(
    model: HammersteinModel,
    monkeypatch: pytest.MonkeyPatch,
    offset_deg: float,
    says: str,
    named: list[str],
) -> None:
    monkeypatch.setattr(verdict, "by_share_left", lambda *_: "partly_explained")
    disc = applied("encoder_eccentricity", "", cosine=0.025, sine=0.0)
    offset = applied("phase_offset", "", offset_deg=offset_deg)
    found = diagnose([measured(3, disc, offset)], model)
    assert (found.verdict, [cause.name for cause in found.causes]) == (says, named)


def test_a_cause_that_looks_a_little_like_two_others_is_not_named(model: HammersteinModel) -> None:
    offset = applied("phase_offset", "", offset_deg=0.8)
    found = diagnose([measured(12, offset, _THREE[0])], model)
    assert found.verdict == "explained"
    assert {cause.name for cause in found.causes} == {"phase_offset", "gain_asymmetry"}


def test_what_predicts_worse_is_no_name(
    model: HammersteinModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = measured(12, applied("phase_offset", "", offset_deg=0.5))
    (cause,) = diagnose([record], model).causes
    assert cause.name == "phase_offset"
    monkeypatch.setattr(held, "foretells_nothing", lambda *_, **__: True)
    found = diagnose([record], model)
    assert found.verdict == "unexplained"
    assert found.causes == ()
    assert found.remainder is not None
    assert found.extended.effects == ()
    assert len(set(found.warnings)) == len(found.warnings)


@pytest.mark.parametrize(("scatter", "verdict"), [(0.0, "explained"), (8.0, "partly_explained")])
def test_windows_that_scatter_beside_a_name_are_told(
    model: HammersteinModel, scatter: float, verdict: str
) -> None:
    record = measured(300, applied("speed_scale", "", scale_error=0.3))
    noise = np.random.default_rng(1).standard_normal(record.t_s.size)
    wide = record.speed_rad_s + scatter * NOISE_RAD_S * noise
    found = diagnose([replace(record, speed_rad_s=wide)], model)
    assert [cause.name for cause in found.causes] == ["speed_scale"]
    assert found.verdict == verdict
    assert (found.remainder is not None) == bool(scatter)
    if found.remainder is not None:
        assert "times as widely as in the model's runs" in found.remainder.says


@pytest.mark.parametrize(("n_named", "says"), [(1, "partly_explained"), (2, "unexplained")])
def test_several_causes_that_leave_something_have_no_name(
    model: HammersteinModel, monkeypatch: pytest.MonkeyPatch, n_named: int, says: str
) -> None:
    monkeypatch.setattr(verdict, "by_share_left", lambda *_: "partly_explained")
    assert diagnose([measured(12, *_THREE[:n_named])], model).verdict == says


def test_a_hum_is_no_noise_of_a_model_that_states_its_noise(model: HammersteinModel) -> None:
    by_hand = replace(model, residual={})
    healthy = measured(3)
    assert diagnose([healthy], by_hand).verdict == "no_discrepancy"
    hum = 0.2 * np.sin(2.0 * np.pi * 7.3 * healthy.t_s)
    humming = replace(healthy, speed_rad_s=healthy.speed_rad_s + hum)
    found = diagnose([humming], by_hand)
    assert (found.verdict, found.causes) == ("unexplained", ())


@pytest.mark.parametrize(("reversals", "named"), [(2, False), (60, True)])
def test_a_cause_that_acts_on_a_handful_of_windows_is_not_named(
    model: HammersteinModel, reversals: int, named: bool
) -> None:
    phase_deg = 60.0 * np.sign(np.sin(np.arange(2000) * np.pi * (reversals + 0.5) / 2000.0 + 1e-6))
    found = diagnose([driven(phase_deg, 17, applied("coupling_backlash", "", gap_rad=0.1))], model)
    assert ("coupling_backlash" in [cause.name for cause in found.causes]) == named
