"""Run a model free: commands in, speeds out, and where the model had no right to answer."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import fitted_start_rad_s, free_run
from usmbench.model.operating_points import point_weights

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
        identified on, shape (N,). There the curve is held at its end.
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
) -> Simulation:
    """Run a model free over a sequence of commands.

    Parameters
    ----------
    model
        The model.
    phase_deg
        Commanded phase of each window, shape (N,).
    frequency_hz, torque_nm
        Commanded drive frequency and load torque of each window, shape (N,); None where
        unknown, which a model with a single operating point takes as being there.
    measured_rad_s
        Measured speed, shape (N,): only what the motor did before the first window is taken from
        its first windows. None starts settled at the first command.

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
    settled_rad_s = np.zeros(phase_deg.size)
    outside_phase = np.zeros(phase_deg.size, dtype=np.bool_)
    for point, weight in zip(model.points, weights, strict=True):
        rows = weight != 0.0
        if not np.any(rows):
            continue
        here_deg = phase_deg[rows]
        settled_rad_s[rows] += weight[rows] * point.curve.speed_rad_s(here_deg)
        low_deg, high_deg = point.phase_range_deg
        outside_phase[rows] |= (here_deg < low_deg) | (here_deg > high_deg)
    start_rad_s = None
    if measured_rad_s is not None:
        start_rad_s = fitted_start_rad_s(model.linear, settled_rad_s, measured_rad_s)
    speed_rad_s = free_run(model.linear, settled_rad_s, start_rad_s)
    return Simulation(speed_rad_s, settled_rad_s, outside_phase, outside_point)
