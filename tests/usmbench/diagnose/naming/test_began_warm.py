"""A motor that warms, and is warm already when a run begins."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import CURVE, LINEAR, NOISE_RAD_S, WINDOW_S
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

CONSTANT_S, LOSES = 15.0, 0.02


def driven(
    seed: int, begins: float = 0.0, *, loses: float = LOSES, drag_rad_s: float = 0.0
) -> Record:
    """Return a run of 25 s of a motor that loses speed as it warms."""
    rng = np.random.default_rng(seed)
    phase_deg = np.repeat(rng.uniform(-88.0, 88.0, 500), 5)
    t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
    warm = 1.0 - (1.0 - begins) * np.exp(-t_s / CONSTANT_S)
    settled = CURVE.speed_rad_s(phase_deg) * (1.0 - loses * warm)
    settled = np.sign(settled) * np.maximum(np.abs(settled) - drag_rad_s, 0.0)
    speed = free_run(LINEAR, settled, float(settled[0]))
    noisy = speed + NOISE_RAD_S * rng.standard_normal(t_s.size)
    return Record(f"run {seed}", t_s, phase_deg, noisy, np.full(t_s.size, WINDOW_S))


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    cold = [driven(k) for k in range(5)]
    return with_knowledge(identify_fast(cold, FastOptions(12)).model, cold)


def test_a_run_that_begins_warm_is_no_news_and_said_to_be_warm(model: HammersteinModel) -> None:
    found = diagnose([driven(11, 0.6)], model)
    assert (found.verdict, found.causes) == ("no_discrepancy", ())
    (said,) = (w for w in found.warnings if "warm when the run began" in w)
    assert said.startswith("run 11: ")
    assert "if it was cold, " in said


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


def test_each_run_that_may_have_begun_warm_may_have_begun_otherwise(
    model: HammersteinModel,
) -> None:
    stretches, _ = cut_runs([driven(16), driven(17)], model, ())
    cold = knowledge_of(model)
    warm = replace(cold, began_warm=("run 16",))
    (plain, plain_root), (shapes, root) = (k.background(stretches) for k in (cold, warm))
    n_more = int(np.count_nonzero(cold.features.warms_at >= 0))
    assert shapes[0].shape[1] == plain[0].shape[1] + 2 * n_more
    assert root.shape[0] == plain_root.shape[0] + 2 * n_more
    more = np.linalg.norm(shapes[0] @ root, axis=1) > np.linalg.norm(plain[0] @ plain_root, axis=1)
    assert np.mean(more) > 0.8
