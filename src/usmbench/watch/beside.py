"""The simulation beside the rows as they come, and its curve and band."""

from collections.abc import Iterator
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.operating_points import point_weights
from usmbench.model.same_windows import check_windows
from usmbench.model.simulate import simulate
from usmbench.runs.pauses import COOLED_S
from usmbench.watch.driven_so_far import DrivenSoFar

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
    frequency_hz, torque_nm, angle_rad, drive_on
        As in the run folder; NaN where the run does not say.
    """

    t_s: Array
    phase_deg: Array
    speed_rad_s: Array
    frequency_hz: Array
    torque_nm: Array
    angle_rad: Array
    drive_on: Array

    def part(self, rows: slice) -> "Rows":
        """Return some of the rows.

        Parameters
        ----------
        rows
            Which.
        """
        return Rows(**{own.name: getattr(self, own.name)[rows] for own in fields(self)})

    def before(self, later: "Rows") -> "Rows":
        """Return these rows and those that follow on them.

        Parameters
        ----------
        later
            The rows that follow.
        """
        names = [own.name for own in fields(self)]
        return Rows(**{name: np.r_[getattr(self, name), getattr(later, name)] for name in names})


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
        self._lead: Rows | None = None
        self._last_s: float | None = None
        self._cold_s = 0.0
        self._driven = DrivenSoFar(window_s)

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
        before_s = rows.t_s[0] if self._last_s is None else self._last_s
        self._last_s = float(rows.t_s[-1])
        cooled = np.flatnonzero(np.diff(rows.t_s, prepend=before_s) >= COOLED_S)
        speeds: list[Array] = []
        for cold, part in _parts(rows, cooled):
            if cold:
                self._cold_s = float(part.t_s[0]) - self._window_s
                self._driven, self._lead = DrivenSoFar(self._window_s), None
            speeds += self._since_cold(replace(part, t_s=part.t_s - self._cold_s))
        return np.concatenate(speeds)

    def _since_cold(self, rows: Rows) -> Iterator[Array]:
        """Yield the simulated speeds, from pause to pause."""
        for stood, part in _parts(rows, self._driven.add(rows.t_s, rows.drive_on)):
            if stood:  # it does not turn on
                self._lead = None
            yield self._go_on(part)

    def _go_on(self, rows: Rows) -> Array:
        """Return the simulated speed of rows without a pause among them."""
        joined = rows if self._lead is None else self._lead.before(rows)
        self._lead = joined.part(slice(-LEAD_ROWS, None))
        middle_rad = joined.angle_rad - 0.5 * self._window_s * joined.speed_rad_s
        simulation = simulate(
            self._model,
            joined.phase_deg,
            _known(joined.frequency_hz),
            _known(joined.torque_nm),
            measured_rad_s=joined.speed_rad_s,
            t_s=joined.t_s,
            angle_rad=_known(middle_rad),
            driving=self._driven.driving,
        )
        speeds = np.where(simulation.inside, simulation.speed_rad_s, np.nan)
        return speeds[-rows.t_s.size :]

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


def _parts(rows: Rows, starts: NDArray[np.intp]) -> Iterator[tuple[bool, Rows]]:
    """Yield rows cut before some of them, and whether each part begins with one of these."""
    cuts = np.unique([0, *starts, rows.t_s.size])
    for first, end in pairwise(cuts.tolist()):
        yield bool(np.isin(first, starts)), rows.part(slice(first, end))


def _known(column: Array) -> Array | None:
    """Return the column, None where the run does not have it."""
    return None if np.isnan(column).any() else column
