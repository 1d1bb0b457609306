"""An experiment that is proposed, and the run that it would give."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.simulate import simulate
from usmbench.runs.record import Record
from usmbench.settings.plan import Plan
from usmbench.settings.plan_file import parse_plan
from usmbench.settings.yaml_source import Source
from usmbench.sweep.schedule import schedule

Array = NDArray[np.float64]
Document = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Experiment:
    """A plan and what it is in words.

    Parameters
    ----------
    says
        What is driven, the end of a sentence.
    document
        The plan, as its file says it.
    """

    says: str
    document: Document

    @property
    def plan(self) -> Plan:
        """The checked plan."""
        return parse_plan(Source("the proposed plan", self.document))

    @property
    def hold_windows(self) -> int:
        """Windows for which each phase is held at least."""
        free = self.document.get("excitation")
        held: int = self.document["dwell"]["windows"] if free is None else free["hold_windows"]
        return held

    def lasts(self, window_s: float) -> str:
        """Say how long it takes.

        Parameters
        ----------
        window_s
            Duration of a window; the plan counts in windows.
        """
        n = sum(dwell.windows for dwell in schedule(self.plan, window_s))
        return f"{n * window_s:.0f} s in windows of {1e3 * window_s:g} ms"

    def repeated(self, times: int) -> "Experiment":
        """Return the same experiment, several times as long.

        Parameters
        ----------
        times
            How many times.
        """
        document = dict(self.document)
        if "excitation" in document:
            excitation = document["excitation"]
            document["excitation"] = {**excitation, "duration_s": times * excitation["duration_s"]}
        else:
            document["passes"] = [
                {**one, "repeats": times * one.get("repeats", 1)} for one in document["passes"]
            ]
        return Experiment(f"{self.says}, {times} times as long", document)


def planned_record(plan: Plan, model: HammersteinModel, window_s: float) -> Record:
    """Return the run that a plan would give if the motor did what the model says.

    Parameters
    ----------
    plan
        The plan.
    model
        The model.
    window_s
        Duration of a window.
    """
    dwells = list(schedule(plan, window_s))
    windows = [dwell.windows for dwell in dwells]

    def column(value: Any) -> Array:
        return np.repeat([float(value(dwell)) for dwell in dwells], windows)

    phase_deg = column(lambda dwell: dwell.phase_deg)
    record = Record(
        plan.name,
        window_s * np.arange(1.0, phase_deg.size + 1.0),
        phase_deg,
        np.zeros(phase_deg.size),
        np.full(phase_deg.size, window_s),
        frequency_hz=column(lambda dwell: dwell.frequency_hz),
        torque_nm=column(lambda dwell: dwell.torque_nm),
    )
    run = simulate(model, phase_deg, record.frequency_hz, record.torque_nm, t_s=record.t_s)
    return replace(record, speed_rad_s=run.speed_rad_s)
