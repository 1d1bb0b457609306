"""A run's commands through a model, free-running, beside what was measured."""

from collections.abc import Iterator
from dataclasses import astuple, dataclass
from typing import Any

import numpy as np

from usmbench.errors import InputError
from usmbench.model.driving import driving_of, stops
from usmbench.model.effects.context import middle_rad
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.same_motor import another_motor
from usmbench.model.same_windows import check_windows
from usmbench.model.scores import fit_percent, rmse
from usmbench.model.simulate import Simulation, simulate
from usmbench.runs.check_record import changed_since_closed, check_numbers
from usmbench.runs.doubtful_units import doubtful_units
from usmbench.runs.pauses import cold_starts
from usmbench.runs.record import Column, Record
from usmbench.runs.shaft_angle import angle_goes_with_speed, angle_warnings


@dataclass(frozen=True, slots=True)
class Replay:
    """A simulation beside its measurement.

    Parameters
    ----------
    simulation
        The free run.
    rmse_rad_s, fit_percent
        Scores over the rows on which the model may be used; the fit is None where the
        measurement is constant.
    warnings
        What the user ought to know, one sentence each.
    """

    simulation: Simulation
    rmse_rad_s: float
    fit_percent: float | None
    warnings: tuple[str, ...]

    def to_json(self) -> dict[str, Any]:
        """Return the mapping that ``replay --json`` writes."""
        return {
            "n": int(np.count_nonzero(self.simulation.inside)),
            "rmse_rad_s": self.rmse_rad_s,
            "fit_percent": self.fit_percent,
            "n_outside": int(np.count_nonzero(~self.simulation.inside)),
            "warnings": list(self.warnings),
        }


def replay_record(record: Record, model: HammersteinModel) -> Replay:
    """Simulate a run's commands and score the result on the rows inside the model's range.

    Parameters
    ----------
    record
        The run.
    model
        The model.

    Raises
    ------
    InputError
        The run's windows differ from the model's, a value is no number, or the whole run lies
        outside the model's range.
    """
    check_numbers(record)
    warnings = [*changed_since_closed([record]), *another_motor([record], model)]
    warnings += doubtful_units([record])
    warnings += _check_windows(record, model)
    warnings += angle_warnings(record)
    parts = [
        simulation for part in cold_starts(record, 1) for simulation in _simulated(part, model)
    ]
    simulation = Simulation(*map(np.concatenate, zip(*map(astuple, parts), strict=True)))
    inside = simulation.inside
    if not np.any(inside):
        raise InputError(
            f"{record.name}: every row lies outside the model's range ({_range(model)}); identify "
            "a model on a run like this one"
        )
    for rows, what in (
        (simulation.outside_phase, "phase"),
        (simulation.outside_point, "frequency or torque"),
    ):
        if np.any(rows):
            warnings.append(
                f"{record.name}: {np.count_nonzero(rows)} of {rows.size} rows (first: row "
                f"{int(np.argmax(rows))}) are outside the model's {what} range ({_range(model)}) "
                "and not scored"
            )
    measured, simulated = record.speed_rad_s[inside], simulation.speed_rad_s[inside]
    return Replay(
        simulation, rmse(measured, simulated), fit_percent(measured, simulated), tuple(warnings)
    )


def _simulated(record: Record, model: HammersteinModel) -> Iterator[Simulation]:
    """Run the model free over a run's commands, anew after each pause: it does not turn on."""
    angle_rad, driving = middle_angle_rad(record), driving_of(record)
    paused = stops(record.t_s, record.usual_window_s, record.driven)
    for rows in np.split(np.arange(record.t_s.size), paused):
        part = record.rows(rows)
        yield simulate(
            model,
            part.phase_deg,
            part.frequency_hz,
            part.torque_nm,
            measured_rad_s=part.speed_rad_s,
            t_s=part.t_s,
            angle_rad=angle_rad[rows],
            driving=driving,
        )


def middle_angle_rad(record: Record) -> Column:
    """Return the shaft angle at the middle of each window, from the counter.

    Parameters
    ----------
    record
        The run; without a column `angle_rad` that goes with them the speeds are added up.
    """
    if record.angle_rad is None or not angle_goes_with_speed(record):
        return middle_rad(record.speed_rad_s, record.window_s)
    return record.angle_rad - 0.5 * record.speed_rad_s * record.window_s


def _check_windows(record: Record, model: HammersteinModel) -> list[str]:
    """Refuse windows of another length; warn where the model has no time step."""
    check_windows(record.name, record.usual_window_s, model.linear)
    if model.linear.window_s is None:
        return ["the model was identified on settled pairs: its dynamics have no time step"]
    return []


def _range(model: HammersteinModel) -> str:
    """Say where the model may be used."""
    parts = []
    for point in model.points:
        where = f"φ {point.phase_range_deg[0]:g}…{point.phase_range_deg[1]:g}°"
        if point.frequency_hz is not None:
            where += f" at {point.frequency_hz:g} Hz"
        if point.torque_nm is not None:
            where += f" {point.torque_nm:g} N·m"
        parts.append(where)
    more = f" and {len(parts) - 3} more" if len(parts) > 3 else ""
    return "; ".join(parts[:3]) + more
