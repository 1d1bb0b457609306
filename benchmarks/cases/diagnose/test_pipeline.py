"""A motor known to the last figure, an effect put into its runs, and what diagnose says."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import NOISE_RAD_S, WINDOW_S, applied, driven, measured, wandering
from tests.usmbench.diagnose.hidden_effect import assert_named
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.applied import Applied
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import free_run
from usmbench.model.replay import replay_record
from usmbench.runs.pauses import COOLED_S
from usmbench.runs.record import Record


@pytest.mark.parametrize("seed", range(2))
def test_names_what_another_day_hides(seed: int) -> None:
    draw = np.random.default_rng([seed, 31])
    faster = applied("speed_scale", "", scale_error=float(draw.uniform(0.012, 0.018)))
    drag = applied("load_torque", "drag", drag_rad_s=float(draw.uniform(0.06, 0.12)))
    found = diagnose([measured(40 + seed, faster, drag)], wandering())
    (cause,) = found.causes
    assert cause.name == "load_torque"
    (estimate,) = cause.parameters
    assert estimate.value == pytest.approx(drag.values["drag_rad_s"], abs=0.02)
    assert any("its gain shows on another day" in warning for warning in found.warnings)


def test_an_offset_is_found_alone_where_the_curve_has_not_levelled_off_at_its_ends() -> None:
    offset_deg = -5.0
    rng = np.random.default_rng(8)
    lag = first_order(0.0035, 0.0015, WINDOW_S)

    def driven_within_40_deg(wrong_deg: float) -> Record:
        phase_deg = np.repeat(rng.uniform(-40.0, 40.0, 400), 8)
        size = np.maximum(np.abs(phase_deg + wrong_deg) - 12.0, 0.0)
        settled = np.sign(phase_deg + wrong_deg) * 9.0 * np.tanh(size / 40.0)
        noisy = free_run(lag, settled) + NOISE_RAD_S * rng.standard_normal(phase_deg.size)
        t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
        return Record("run", t_s, phase_deg, noisy, np.full(phase_deg.size, WINDOW_S))

    references = [driven_within_40_deg(0.0) for _ in range(2)]
    model = with_knowledge(identify_fast(references, FastOptions()).model, references)
    found = diagnose([driven_within_40_deg(offset_deg)], model)
    assert [cause.name for cause in found.causes] == ["phase_offset"]
    (offset,) = found.causes[0].parameters
    assert offset.value == pytest.approx(offset_deg, abs=0.03)
    assert found.rmse_extended_rad_s < 1.05 * found.noise_floor_rad_s


def test_speeds_in_another_unit_are_a_scale(model: HammersteinModel) -> None:
    run, rpm_of_rad_s = measured(7), 30.0 / np.pi
    found = diagnose([replace(run, speed_rad_s=rpm_of_rad_s * run.speed_rad_s)], model)
    assert [cause.name for cause in found.causes] == ["speed_scale"]
    (error,) = found.causes[0].parameters
    assert error.value == pytest.approx(rpm_of_rad_s - 1.0, rel=0.02)


@pytest.mark.parametrize(
    "hidden",
    [
        applied("transport_delay", "", delay_s=3e-4),
        applied("slow_dynamics", "", added_s=3e-4),
        applied("coupling_backlash", "", gap_rad=1.5e-3),
    ],
    ids=lambda hidden: hidden.effect.name,
)
def test_a_small_part_of_a_window_or_a_count_is_named(
    model: HammersteinModel, hidden: Applied
) -> None:
    found = diagnose([measured(9, hidden)], model)
    assert found.causes[0].name == hidden.effect.name


def test_a_small_cause_is_named_beside_a_large_one_that_hardly_acts_where_it_does(
    model: HammersteinModel,
) -> None:
    rng = np.random.default_rng(3)
    late = applied("transport_delay", "", delay_s=0.006)
    warms = applied("thermal_drift", "speed", final_drift=-0.015, warm_up_s=15.0)
    found = diagnose([driven(np.repeat(rng.uniform(-88.0, 88.0, 100), 20), 13, late, warms)], model)
    assert [cause.name for cause in found.causes] == ["transport_delay", "thermal_drift"]


@pytest.mark.parametrize(("starts", "named"), [(1, False), (6, True)])
def test_what_shows_at_a_few_starts_only_is_named_from_several_on(
    model: HammersteinModel, starts: int, named: bool
) -> None:
    stop = np.r_[np.arange(60.0, 0.0, -1.3), np.zeros(20), np.arange(0.0, 60.0, 1.3)]
    runs_on = np.full(2000 // starts - stop.size, 60.0)
    sticking = applied("dead_zone_hysteresis", "sticking", start_later_deg=3.0)
    found = diagnose([driven(np.tile(np.r_[runs_on, stop], starts), 19, sticking)], model)
    assert ("dead_zone_hysteresis" in [cause.name for cause in found.causes]) == named


def test_the_same_runs_give_the_same_words(model: HammersteinModel) -> None:
    record = measured(11, applied("speed_scale", "", scale_error=0.01))
    assert diagnose([record], model).to_json() == diagnose([record], model).to_json()


def test_a_motor_that_cooled_in_a_pause_warms_again(model: HammersteinModel) -> None:
    warming = applied("thermal_drift", "speed", final_drift=-0.05, warm_up_s=20.0)
    first, second = measured(7, warming), measured(8, warming)
    record = replace(
        first,
        t_s=np.r_[first.t_s, first.t_s[-1] + COOLED_S + second.t_s],
        phase_deg=np.r_[first.phase_deg, second.phase_deg],
        speed_rad_s=np.r_[first.speed_rad_s, second.speed_rad_s],
        window_s=np.r_[first.window_s, second.window_s],
    )
    found = diagnose([record], model)
    assert [cause.name for cause in found.causes] == ["thermal_drift"]
    assert found.verdict == "explained"
    replayed = replay_record(record, found.extended)
    assert replayed.rmse_rad_s < 1.3 * found.noise_floor_rad_s


@pytest.mark.parametrize(
    ("hidden", "parameter"),
    [
        (applied("load_torque", "weight", one_sided_rad_s=0.1), "one_sided_rad_s"),
        (applied("unsigned_counts", ""), None),
        (applied("swapped_channels", "of the drive"), None),
        (applied("phase_scale", "", scale_error=-0.03), "scale_error"),
    ],
    ids=lambda value: value.effect.form or value.effect.name if isinstance(value, Applied) else "",
)
def test_names_what_was_hidden(
    model: HammersteinModel, hidden: Applied, parameter: str | None
) -> None:
    assert_named(model, hidden, parameter)
