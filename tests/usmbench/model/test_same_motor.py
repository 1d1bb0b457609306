"""A run of another motor than the model's runs is told, in one line."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from known_motor import identified, measured
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.model_file import read_model, write_model
from usmbench.model.replay import replay_record
from usmbench.model.same_motor import another_motor
from usmbench.runs.record import Record

HERE = {"motor": "round one", "encoder": {"counts_per_rev": 2000}}


def _run(meta: dict[str, Any], name: str = "a run") -> Record:
    window = np.ones(1)
    return Record(name, window, window, window, window, meta=meta)


def _model(*said: dict[str, Any]) -> HammersteinModel:
    return replace(identified(), fitted_on=tuple({"name": "a", **run} for run in said))


SAID = {"motor": "round one", "counts_per_rev": 2000}


def test_another_motor_is_told_in_one_line() -> None:
    runs = [_run({**HERE, "motor": "flat one"}, name) for name in ("b", "c", "d")]
    (line,) = another_motor(runs, _model(SAID, SAID))
    assert line.startswith("b and 2 more: motor is flat one here and round one in the runs of the ")
    assert "\n" not in line


def test_another_disc_is_told_in_one_line() -> None:
    (line,) = another_motor([_run({"encoder": {"counts_per_rev": 4096}})], _model(SAID))
    assert line.startswith("a run: counts_per_rev is 4096 here and 2000 in the runs of the model;")


@pytest.mark.parametrize("meta", [HERE, {}, {"motor": None, "encoder": {}}])
def test_what_a_run_does_not_say_may_be_anything(meta: dict[str, Any]) -> None:
    assert another_motor([_run(meta)], _model(SAID)) == []


@pytest.mark.parametrize("said", [{}, {"motor": None, "counts_per_rev": None}])
def test_so_may_what_the_models_runs_do_not_say(said: dict[str, Any]) -> None:
    assert another_motor([_run(HERE)], _model(said)) == []


def test_a_model_file_says_which_motor_its_runs_were_of(tmp_path: Path) -> None:
    runs = [replace(measured(seed), meta=HERE) for seed in (1, 2)]
    write_model(tmp_path / "model.yaml", identify_fast(runs, FastOptions(12)).model)
    model = read_model(tmp_path / "model.yaml")
    assert [run["motor"] for run in model.fitted_on] == ["round one", "round one"]
    assert [run["counts_per_rev"] for run in model.fitted_on] == [2000, 2000]


def test_replay_and_diagnosis_tell() -> None:
    run = replace(measured(5), meta={**HERE, "motor": "flat one"})
    model = _model(SAID)
    assert any("flat one here and round one" in w for w in replay_record(run, model).warnings)
    assert any("flat one here and round one" in w for w in cut_runs([run], model, ())[1])
