"""Run a model free: commands in, speeds out, and where the model had no right to answer."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.model.applied import foreseen_effects
from usmbench.model.driving import ALWAYS, Driving
from usmbench.model.effects.context import Context
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.mixed_curve import beyond_range, settled_speed
from usmbench.model.operating_points import point_weights
from usmbench.model.resonance_slope import mixed_slope, point_slopes

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Simulation:
    """What a model says about a run.

    Parameters
    ----------
    speed_rad_s
        Free-running speed, shape (N,).
    settled_rad_s
        The static curve's output v, shape (N,).
    outside_phase, outside_point
        True where the phase, or the operating point, lies outside the range the model was
        identified on, shape (N,). There the curve goes on as it ends.
    """

    speed_rad_s: Array
    settled_rad_s: Array
    outside_phase: NDArray[np.bool_]
    outside_point: NDArray[np.bool_]

    @property
    def inside(self) -> NDArray[np.bool_]:
        """True where the model may be used, shape (N,)."""
        return ~(self.outside_phase | self.outside_point)


def simulate(
    model: HammersteinModel,
    phase_deg: Array,
    frequency_hz: Array | None = None,
    torque_nm: Array | None = None,
    *,
    measured_rad_s: Array | None = None,
    t_s: Array | None = None,
    angle_rad: Array | None = None,
    driving: Driving = ALWAYS,
) -> Simulation:
    """Run a model free over a sequence of commands.

    Parameters
    ----------
    model
        The model. Its effects that strike single windows are left out.
    phase_deg
        Commanded phase of each window, shape (N,).
    frequency_hz, torque_nm
        Commanded drive frequency and load torque of each window, shape (N,); None where
        unknown, which a model with a single operating point takes as being there.
    measured_rad_s
        Measured speed, shape (N,): only what the motor did before the first window is taken from
        its first windows. None starts settled at the first command.
    t_s
        End of each window from the start of the run, shape (N,), for effects that change with
        time; None where the commands start with the run.
    angle_rad
        Shaft angle at the middle of each window, shape (N,), for effects that follow the angle;
        None lets the simulation turn its own shaft.
    driving
        When in the run the motor is driven, for effects that change as it warms.

    Returns
    -------
    Simulation
        Speeds, and the rows on which the model is used outside its range.

    Raises
    ------
    InputError
        No row, a phase that is not a number, or a model with several operating points and
        nothing that says which.
    """
    if phase_deg.size == 0:
        raise InputError("there is no row to simulate")
    if not np.all(np.isfinite(phase_deg)):
        raise InputError(f"phase_deg of row {int(np.argmin(np.isfinite(phase_deg)))} is no number")
    weights, outside_point = point_weights(model.points, phase_deg.size, frequency_hz, torque_nm)
    window_s = 1.0 if model.linear.window_s is None else model.linear.window_s
    if t_s is None:
        t_s = window_s * np.arange(1.0, phase_deg.size + 1.0)
    context = Context(
        t_s,
        window_s,
        phase_deg,
        settled_speed(model.points, weights),
        model.linear,
        angle_rad,
        detuning_rad_s=mixed_slope(point_slopes(model.points), weights),
        driving=driving,
    )
    run = extended_run(foreseen_effects(model.effects), context, measured_rad_s)
    outside_phase = beyond_range(model.points, weights, phase_deg)
    return Simulation(run.speed_rad_s, run.settled_rad_s, outside_phase, outside_point)
