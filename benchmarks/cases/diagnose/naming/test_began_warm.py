"""A motor that warms, and is warm already when a run begins."""

from dataclasses import replace

import pytest

from tests.usmbench.diagnose.naming.warming_motor import LOSES, driven, known_cold
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.hammerstein import HammersteinModel


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return known_cold()


def test_a_drag_is_named_beside_a_warm_start(model: HammersteinModel) -> None:
    found = diagnose([driven(12, 0.8, drag_rad_s=0.1)], model)
    assert [cause.name for cause in found.causes] == ["load_torque"]
    size = {p.name: p for p in found.causes[0].parameters}["drag_rad_s"]
    assert size.low < 0.1 < size.high < 0.2
    assert any("warm when the run began" in w for w in found.warnings)


def test_one_of_two_runs_of_a_name_began_warm(model: HammersteinModel) -> None:
    found = diagnose([driven(13), replace(driven(14, 0.8), name="run 13")], model)
    assert found.verdict == "no_discrepancy"
    said = [w for w in found.warnings if "warm when the run began" in w]
    assert [w.split(":")[0] for w in said] == ["run 13"]


def test_a_motor_that_warms_twice_as_much_drifts(model: HammersteinModel) -> None:
    found = diagnose([driven(15, loses=2.0 * LOSES)], model)
    assert [cause.name for cause in found.causes] == ["thermal_drift"]
    assert not any("warm when the run began" in w for w in found.warnings)


def test_a_run_that_begins_warm_is_no_news_and_said_to_be_warm(model: HammersteinModel) -> None:
    found = diagnose([driven(11, 0.6)], model)
    assert (found.verdict, found.causes) == ("no_discrepancy", ())
    (said,) = (w for w in found.warnings if "warm when the run began" in w)
    assert said.startswith("run 11: ")
    assert "if it was cold, " in said
