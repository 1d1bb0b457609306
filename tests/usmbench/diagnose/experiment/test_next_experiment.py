"""The experiment that decides: proposed where something is open, and it does decide."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from usmbench.diagnose.evidence import Candidate, Estimate, NamedCause
from usmbench.diagnose.experiment.next_experiment import propose, question_of
from usmbench.diagnose.result import Diagnosis
from usmbench.model.hammerstein import HammersteinModel, LinearPart, OperatingPoint, StaticCurve
from usmbench.model.simulate import simulate
from usmbench.runs.record import Record

Make = Callable[..., Diagnosis]
DELAY = Estimate("delay_s", 0.04, 0.035, 0.045, "s")
WIDTH = Estimate("width_deg", 1.0, 0.8, 1.2, "deg")
NOISE_RAD_S = 0.03


@pytest.fixture
def model() -> HammersteinModel:
    knots_deg = np.array([-90.0, -45.0, 0.0, 45.0, 90.0])
    curve = StaticCurve(knots_deg, np.array([-10.0, -8.0, 0.0, 8.0, 10.0]))
    point = OperatingPoint(41_000.0, 0.0, curve, (-90.0, 90.0), (-4.0, 4.0), NOISE_RAD_S)
    linear = LinearPart(np.array([-0.04]), np.array([0.59, 0.37]), 0, 0.01)
    return HammersteinModel(linear, (point,), "test")


@pytest.fixture
def triangle(model: HammersteinModel) -> Record:
    """A triangle at one rate, driven on a motor that acts 40 ms late."""
    there = np.r_[
        np.arange(0.0, 90.0, 0.5), np.arange(90.0, -90.0, -0.5), np.arange(-90.0, 0.0, 0.5)
    ]
    phase_deg = np.repeat(there, 4)
    late = {"name": "transport_delay", "form": "", "parameters": {"delay_s": 0.04}}
    speed_rad_s = simulate(replace(model, effects=(late,)), phase_deg).speed_rad_s
    noise_rad_s = NOISE_RAD_S * np.random.default_rng(5).standard_normal(phase_deg.size)
    window_s = np.full(phase_deg.size, 0.01)
    return Record("triangle", np.cumsum(window_s), phase_deg, speed_rad_s + noise_rad_s, window_s)


@pytest.fixture
def make_diagnosis(model: HammersteinModel) -> Make:
    def make(**changes: Any) -> Diagnosis:
        named = NamedCause(
            "dead_zone_hysteresis",
            "directed edges",
            "",
            "",
            ("transport_delay",),
            (WIDTH,),
            1e-9,
            0.9,
        )
        content: dict[str, Any] = {
            "verdict": "explained",
            "causes": (named,),
            "candidates": (
                Candidate(
                    "dead_zone_hysteresis", "directed edges", "", 100.0, 1, 1e-9, 1, (WIDTH,)
                ),
                Candidate("transport_delay", "", "", 99.0, 1, 1e-9, 1, (DELAY,)),
            ),
            "not_testable": (),
            "rmse_simulation_rad_s": 0.1,
            "rmse_extended_rad_s": 0.03,
            "noise_floor_rad_s": 0.03,
            "gain": 0.9,
            "gain_low": 0.8,
            "gain_high": 1.0,
            "remainder": None,
            "minimum_detectable": (),
            "views": (),
            "traces": (),
            "extended": model,
            "n_windows": 2880,
        }
        return Diagnosis(**{**content, **changes})

    return make


def test_what_looks_alike_in_a_triangle_of_one_rate_is_told_apart_by_another_plan(
    make_diagnosis: Make, triangle: Record, model: HammersteinModel
) -> None:
    proposal = propose(make_diagnosis(), [triangle], model)
    assert proposal is not None
    assert "dead zone hysteresis and transport delay" in proposal["says"]
    assert proposal["odds_before"] < 0.2
    assert proposal["odds_after"] > 0.99
    assert proposal["plan"]["format"] == "usmbench-plan/1"


def test_much_noise_makes_the_experiment_longer_or_its_odds_worse(
    make_diagnosis: Make, triangle: Record, model: HammersteinModel
) -> None:
    loud_rad_s = 3.0 * np.random.default_rng(6).standard_normal(triangle.t_s.size)
    loud = replace(triangle, speed_rad_s=triangle.speed_rad_s + loud_rad_s)
    proposal = propose(make_diagnosis(), [loud], model)
    if proposal is not None:
        assert "4 times as long" in proposal["says"] or proposal["odds_after"] > 0.95


def test_without_alternatives_nothing_is_proposed(
    make_diagnosis: Make, triangle: Record, model: HammersteinModel
) -> None:
    found = make_diagnosis()
    alone = replace(found, causes=(replace(found.causes[0], alternatives=()),))
    assert question_of(alone) is None
    assert propose(alone, [triangle], model) is None
    assert propose(replace(found, verdict="unexplained", causes=()), [triangle], model) is None


def test_an_effect_too_small_to_name_gets_a_plan_that_shows_it(
    make_diagnosis: Make, triangle: Record, model: HammersteinModel
) -> None:
    rng = np.random.default_rng(7)
    quiet = simulate(model, triangle.phase_deg).speed_rad_s
    healthy = replace(triangle, speed_rad_s=quiet + NOISE_RAD_S * rng.standard_normal(quiet.size))
    hint = Candidate("transport_delay", "", "", 8.0, 1, 0.06, 0.1, (DELAY,))
    found = make_diagnosis(verdict="no_discrepancy", causes=(), candidates=(hint,))
    gained = []
    for delay_s in (0.0005, 0.001, 0.002, 0.004, 0.008):
        small = replace(hint, parameters=(replace(DELAY, value=delay_s),))
        proposal = propose(replace(found, candidates=(small,)), [healthy], model)
        if proposal is not None:
            assert "To see whether there is any transport delay: " in proposal["says"]
            gained.append(proposal["odds_after"] - proposal["odds_before"])
    # The smallest show under no plan; the largest did not show, though the model says they would.
    assert max(gained) > 0.25
    assert proposal is not None
    assert proposal["odds_before"] == 0.5
    faint = replace(found, candidates=(replace(hint, p_value=0.7),))
    assert propose(faint, [healthy], model) is None


def test_causes_that_act_beside_the_rivals_are_kept(make_diagnosis: Make) -> None:
    found = make_diagnosis()
    scale = Estimate("scale_error", 0.02, 0.01, 0.03, "1")
    second = NamedCause("speed_scale", "", "", "", (), (scale,), 1e-9, 0.1)
    rate = Estimate("rate_hz", 0.1, 0.0, 0.2, "1/s")
    size = Estimate("size_rad_s", 1.0, 0.0, 2.0, "rad/s")
    glitches = NamedCause("count_glitches", "", "", "", (), (rate, size), 1e-9, 0.0)
    question = question_of(replace(found, causes=(second, found.causes[0], glitches)))
    assert question is not None
    assert [a.effect.name for a in question.given] == ["speed_scale"]
    names = [None if a is None else a.effect.name for a in question.rivals]
    assert names == ["dead_zone_hysteresis", "transport_delay"]


def test_a_cause_that_is_named_already_is_no_rival(make_diagnosis: Make) -> None:
    found = make_diagnosis()
    delay = NamedCause("transport_delay", "", "", "", (), (DELAY,), 1e-9, 0.1)
    assert question_of(replace(found, causes=(found.causes[0], delay))) is None
