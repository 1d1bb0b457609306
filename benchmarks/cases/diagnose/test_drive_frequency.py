"""Two causes that are one at one drive frequency, on a motor with a resonance, and told at two."""

from dataclasses import replace

import pytest

from benchmarks.cases.diagnose.motor_at_two_frequencies import (
    ABOVE_HZ,
    BELOW_HZ,
    driven_at,
    known_at_two,
    names_and_alternatives,
)
from usmbench.diagnose.experiment.next_experiment import propose
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.diagnose.result import Diagnosis
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return known_at_two()


@pytest.fixture(scope="module")
def slower(model: HammersteinModel) -> tuple[Record, Diagnosis]:
    """Return a run at one frequency whose crystal is off, and what is said of it."""
    record = driven_at(7, (ABOVE_HZ,), 150.0, 0.0)
    return record, diagnose([record], model)


@pytest.mark.parametrize(
    ("ppm", "weaker", "name", "other"),
    [
        (40.0, 0.0, "crystal_error", "generator_imbalance"),
        (-40.0, 0.0, "crystal_error", "generator_imbalance"),
        (0.0, 0.005, "generator_imbalance", "crystal_error"),
    ],
)
def test_two_drive_frequencies_tell_a_crystal_from_a_generator(
    model: HammersteinModel, ppm: float, weaker: float, name: str, other: str
) -> None:
    found = diagnose([driven_at(7, (BELOW_HZ, ABOVE_HZ), ppm, weaker)], model)
    assert [cause.name for cause in found.causes] == [name]
    assert other not in names_and_alternatives(found)
    (size,) = found.causes[0].parameters
    truth = ppm if name == "crystal_error" else weaker
    assert size.value == pytest.approx(truth, rel=0.15)


def test_one_drive_frequency_leaves_both_and_the_more_probable_first(
    model: HammersteinModel, slower: tuple[Record, Diagnosis]
) -> None:
    for found in (slower[1], diagnose([driven_at(7, (ABOVE_HZ,), 0.0, 0.02)], model)):
        assert names_and_alternatives(found) >= {"crystal_error", "generator_imbalance"}
        # A generator can only be weaker, and so explains a loss the more readily.
        assert found.causes[0].name == "generator_imbalance"


def test_a_plan_at_another_frequency_is_proposed_to_decide(
    model: HammersteinModel, slower: tuple[Record, Diagnosis]
) -> None:
    record, found = slower
    proposal = propose(found, [record], model)
    assert proposal is not None
    assert proposal["odds_after"] > 0.9
    assert proposal["plan"]["frequency_hz"] == [ABOVE_HZ, BELOW_HZ]


def test_a_speed_that_rose_is_no_weak_generator(model: HammersteinModel) -> None:
    found = diagnose([driven_at(7, (ABOVE_HZ,), -150.0, 0.0)], model)
    assert found.causes[0].name == "crystal_error"
    assert "generator_imbalance" not in names_and_alternatives(found)


@pytest.fixture(scope="module")
def at_one_frequency(model: HammersteinModel) -> HammersteinModel:
    points = tuple(p for p in model.points if p.frequency_hz == ABOVE_HZ)
    runs = [driven_at(seed, (ABOVE_HZ,), 0.0, 0.0) for seed in (1, 2, 3, 4)]
    return with_knowledge(replace(model, points=points, residual={}), runs)


def test_with_nothing_hidden_two_frequencies_show_nothing(model: HammersteinModel) -> None:
    found = diagnose([driven_at(11, (BELOW_HZ, ABOVE_HZ), 0.0, 0.0)], model)
    assert found.verdict == "no_discrepancy"


def test_a_model_of_one_frequency_leaves_both(at_one_frequency: HammersteinModel) -> None:
    found = diagnose([driven_at(7, (ABOVE_HZ,), 60.0, 0.0)], at_one_frequency)
    assert names_and_alternatives(found) >= {"crystal_error", "generator_imbalance"}
    assert {c.form for c in found.candidates if c.name == "crystal_error"} == {""}
