"""A diagnosis to show, with every part in it."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from usmbench.diagnose.evidence import Candidate, Detectable, Estimate, NamedCause
from usmbench.diagnose.result import Diagnosis, Remainder, Trace, View
from usmbench.model.hammerstein import (
    HammersteinModel,
    LinearPart,
    OperatingPoint,
    StaticCurve,
)
from usmbench.runs.record import Record

Make = Callable[..., Any]


@pytest.fixture
def model() -> HammersteinModel:
    curve = StaticCurve(np.array([-90.0, 0.0, 90.0]), np.array([-9.0, 0.0, 9.0]))
    point = OperatingPoint(41_000.0, 0.0, curve, (-90.0, 90.0), (-4.0, 4.0), 0.04)
    linear = LinearPart(np.array([-0.1]), np.array([0.5, 0.4]), 0, 0.01)
    return HammersteinModel(linear, (point,), method="fast", fitted_on=({"name": "reference"},))


@pytest.fixture
def record() -> Record:
    t_s = 0.01 * np.arange(1.0, 401.0)
    column = np.sin(t_s)
    return Record("measured", t_s, 90.0 * column, 9.0 * column, np.full(400, 0.01))


@pytest.fixture
def make_diagnosis(model: HammersteinModel) -> Make:
    def make(**changes: Any) -> Diagnosis:
        k, t_s = np.arange(8.0), 0.01 * np.arange(1.0, 401.0)
        delay = Estimate("delay_s", 0.0053, 0.0046, 0.0061, "s", "how much later a command acts")
        cause = NamedCause(
            "transport_delay",
            "",
            "Commands act later.",
            "Time a command.",
            ("dead_zone_hysteresis",),
            (delay,),
            1e-9,
            0.8,
        )
        view = View(
            "lag",
            "windows after a step of φ, residual in the step's direction",
            k,
            np.cos(k),
            0.1 * np.cos(k),
            np.full(8, 0.2),
            np.full(8, 50.0),
            5.0,
            0.5,
        )
        content: dict[str, Any] = {
            "verdict": "explained",
            "causes": (cause,),
            "candidates": (
                Candidate("transport_delay", "", "", 200.0, 1, 1e-9, 0.9, (delay,)),
                Candidate("speed_scale", "", "", 1.0, 1, 1.0, 0.0, ()),
            ),
            "not_testable": (("thermal_drift", "the run is too short"),),
            "rmse_simulation_rad_s": 0.2,
            "rmse_extended_rad_s": 0.09,
            "noise_floor_rad_s": 0.04,
            "gain": 0.8,
            "gain_low": 0.7,
            "gain_high": 0.9,
            "remainder": Remainder("time", "the residual changes over the run"),
            "minimum_detectable": (Detectable("speed_scale", "scale_error", 0.002, "1"),),
            "views": (view,),
            "traces": (Trace("measured", t_s, np.sin(t_s), 0.9 * np.sin(t_s), 0.99 * np.sin(t_s)),),
            "extended": model,
            "n_windows": 4000,
            "next_experiment": {
                "says": "Drive the telegraph.",
                "plan": {"format": "usmbench-plan/1", "frequency_hz": 41000},
                "odds_before": 0.55,
                "odds_after": 0.999,
            },
        }
        return Diagnosis(**{**content, **changes})

    return make
