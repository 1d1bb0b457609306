"""What a diagnosis says on a terminal."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.cli.diagnosis_lines import diagnosis_lines
from usmbench.diagnose.evidence import Detectable, Estimate, NamedCause
from usmbench.diagnose.result import Diagnosis
from usmbench.model.hammerstein import HammersteinModel, LinearPart, OperatingPoint, StaticCurve


@pytest.fixture
def found() -> Diagnosis:
    curve = StaticCurve(np.array([-90.0, 0.0, 90.0]), np.array([-9.0, 0.0, 9.0]))
    point = OperatingPoint(41_000.0, 0.0, curve, (-90.0, 90.0), (-4.0, 4.0), 0.04)
    linear = LinearPart(np.array([-0.1]), np.array([0.9]), 0, 0.01)
    delay = Estimate("delay_s", 9.6e-5, 9e-5, 10.2e-5, "s", "how much later it acts")
    cause = NamedCause(
        "transport_delay",
        "of both",
        "It is late.",
        "Time it.",
        ("slow_dynamics",),
        (delay,),
        0.0,
        0.8,
    )
    return Diagnosis(
        "explained",
        (cause,),
        (),
        (("thermal_drift", "too short"),),
        0.2,
        0.09,
        0.04,
        0.8,
        0.7,
        0.9,
        None,
        (),
        (),
        (),
        HammersteinModel(linear, (point,), method="x"),
        4000,
    )


def test_a_cause_is_shown_with_its_form_and_small_sizes_in_small_units(found: Diagnosis) -> None:
    lines = diagnosis_lines(found).splitlines()
    assert lines[1] == "cause      transport_delay (of both): delay 96 µs (90 … 102 µs)"
    assert "           delay_s: how much later it acts" in lines


def test_causes_that_stay_open_without_an_experiment_are_told_so(found: Diagnosis) -> None:
    assert "next       none is proposed: no plan within what this model" in diagnosis_lines(found)
    alone = replace(found, causes=(replace(found.causes[0], alternatives=()),))
    assert "next " not in diagnosis_lines(alone)


def test_odds_are_those_of_the_page(found: Diagnosis) -> None:
    proposal = {"says": "Drive it.", "odds_before": 0.0, "odds_after": 1.0}
    said = diagnosis_lines(replace(found, next_experiment=proposal))
    assert "odds of telling them apart: less than 1 %, then more than 99 %" in said


def test_a_healthy_motor_is_told_what_would_have_been_seen(found: Diagnosis) -> None:
    sizes = [Detectable(f"cause_{k}", "offset_deg", 0.1 * k + 0.1, "deg") for k in range(20)]
    healthy = replace(found, verdict="no_discrepancy", causes=(), minimum_detectable=tuple(sizes))
    said = diagnosis_lines(healthy)
    shown = said[said.index("would show ") :].splitlines()
    assert shown[0].startswith("would show (in 9 of 10 cases) cause_0 0.1°, cause_1 0.2°")
    assert len(shown) > 1
    assert all(len(line) <= 100 and line[:11].strip() in ("would show", "") for line in shown)
    assert " ".join(shown).count("cause_") == 20
    assert "would show" not in diagnosis_lines(found)
