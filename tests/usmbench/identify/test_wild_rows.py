"""A row that no motor makes does not decide what a model is."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.wild_rows import wild_rows, without_wild_rows
from usmbench.runs.record import Record

Measure = Callable[..., Record]


def test_a_run_without_one_is_left_as_it_is(measure: Measure) -> None:
    record = measure()
    assert without_wild_rows(record) is record
    assert not wild_rows(replace(record, speed_rad_s=np.zeros(record.t_s.size))).any()


def test_a_run_that_was_hardly_driven_is_left_as_it_is(measure: Measure) -> None:
    record = measure()
    n_idle = 200 * record.t_s.size
    idle = replace(
        record,
        **{
            name: np.r_[np.full(n_idle, idle), getattr(record, name)]
            for name, idle in (("phase_deg", 0.0), ("speed_rad_s", 0.01), ("window_s", 0.01))
        },
        t_s=np.arange(1.0, n_idle + record.t_s.size + 1.0),
        extra={"drive_on": np.r_[np.zeros(n_idle), np.ones(record.t_s.size)]},
    )
    assert not wild_rows(idle).any()


def test_every_column_loses_the_row(measure: Measure) -> None:
    record = replace(measure(), extra={"own": np.arange(1500.0)}, sweep=np.zeros(1500))
    record.speed_rad_s[200] = -1e6
    less = without_wild_rows(record)
    assert less.sweep is not None
    assert {c.size for c in (less.t_s, less.speed_rad_s, less.sweep, less.extra["own"])} == {1499}
    assert 200.0 not in less.extra["own"]


def test_what_is_known_of_a_model_is_as_without_it(measure: Measure) -> None:
    clean, wild = measure(), measure()
    wild.speed_rad_s[200] = 1e6
    sigmas = []
    for record in (clean, wild):
        model = with_knowledge(identify_fast([record], FastOptions(12)).model, [record])
        assert model.points[0].noise_rad_s == pytest.approx(0.02, rel=0.1)
        sigmas.append(np.mean(model.residual["diagnosis"]["noise"]["sigma_rad_s"]))
    assert sigmas[1] == pytest.approx(sigmas[0], rel=0.05)
