"""The simulation beside the rows as they come, and its curve and band."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.operating_points import point_weights
from usmbench.model.same_windows import check_windows
from usmbench.model.simulate import simulate

Array = NDArray[np.float64]

# The simulation of new rows starts this many rows earlier: 5 s of the paper's windows, a hundred
# times what its motor remembers.
LEAD_ROWS = 500
CURVE_STEP_DEG = 1.0
_TWO_SIDED = 1.96


@dataclass(frozen=True, slots=True)
class Rows:
    """Windows as the simulation takes them; every column has shape (n,).

    Parameters
    ----------
    t_s, phase_deg, speed_rad_s
        End, commanded phase and measured speed of each window.
    frequency_hz, torque_nm, angle_rad
        As in the run folder; NaN where the run does not say.
    """

    t_s: Array
    phase_deg: Array
    speed_rad_s: Array
    frequency_hz: Array
    torque_nm: Array
    angle_rad: Array


@dataclass(frozen=True, slots=True)
class Curve:
    """The model's static curve at one operating point, every array of shape (n,).

    Parameters
    ----------
    phase_deg
        Phases within the model's range.
    speed_rad_s
        Settled speed.
    band_rad_s
        Half the width of the band that 95 % of the windows lie in.
    """

    phase_deg: Array = field(default_factory=lambda: np.empty(0))
    speed_rad_s: Array = field(default_factory=lambda: np.empty(0))
    band_rad_s: float = 0.0


class SimulationBeside:
    """Simulates a run as it is measured, in bounded memory.

    Parameters
    ----------
    model
        The model.
    window_s
        Duration of the run's windows.
    name
        The run's name, for messages.

    Raises
    ------
    usmbench.errors.InputError
        The model was identified on windows of another duration.
    """

    def __init__(self, model: HammersteinModel, window_s: float, name: str):
        check_windows(name, window_s, model.linear)
        self._model = model
        self._window_s = window_s
        self._lead: list[Array] | None = None

    def simulate(self, rows: Rows) -> Array:
        """Return the simulated speed of the rows that follow on those before.

        Parameters
        ----------
        rows
            New rows, at least one.

        Returns
        -------
        ndarray
            Simulated speed in rad/s, shape (n,); NaN outside the model's range.
        """
        new = [
            rows.t_s,
            rows.phase_deg,
            rows.speed_rad_s,
            rows.frequency_hz,
            rows.torque_nm,
            rows.angle_rad,
        ]
        joined = new
        if self._lead is not None:
            joined = [np.concatenate(both) for both in zip(self._lead, new, strict=True)]
        self._lead = [column[-LEAD_ROWS:] for column in joined]
        t_s, phase_deg, speed_rad_s, frequency_hz, torque_nm, angle_rad = joined
        middle_rad = angle_rad - 0.5 * self._window_s * speed_rad_s
        simulation = simulate(
            self._model,
            phase_deg,
            _known(frequency_hz),
            _known(torque_nm),
            measured_rad_s=speed_rad_s,
            t_s=t_s,
            angle_rad=_known(middle_rad),
        )
        speeds = np.where(simulation.inside, simulation.speed_rad_s, np.nan)
        return speeds[-len(rows.t_s) :]

    def curve(self, frequency_hz: float, torque_nm: float) -> Curve:
        """Return the static curve at an operating point.

        Parameters
        ----------
        frequency_hz, torque_nm
            The point; NaN where the run does not say.
        """
        points = self._model.points
        low_deg = min(point.phase_range_deg[0] for point in points)
        high_deg = max(point.phase_range_deg[1] for point in points)
        phase_deg = np.arange(low_deg, high_deg + CURVE_STEP_DEG / 2.0, CURVE_STEP_DEG)
        n = phase_deg.size
        there = [_known(np.full(n, value)) for value in (frequency_hz, torque_nm)]
        simulation = simulate(self._model, phase_deg, *there)
        inside = simulation.inside
        weights, _outside = point_weights(points, n, *there)
        noise_rad_s = sum(
            float(weight[0]) * point.noise_rad_s
            for point, weight in zip(points, weights, strict=True)
        )
        return Curve(phase_deg[inside], simulation.settled_rad_s[inside], _TWO_SIDED * noise_rad_s)


def _known(column: Array) -> Array | None:
    """Return the column, None where the run does not have it."""
    return None if np.isnan(column).any() else column
