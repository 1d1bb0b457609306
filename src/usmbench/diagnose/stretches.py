"""Runs cut into unbroken stretches, each with what the effects and the noise need to know."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.model.effects.base import Context
from usmbench.model.extended import Applied, extended_run
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import memory_windows
from usmbench.model.operating_points import detuning_weights, places_among, point_weights
from usmbench.model.replay import middle_angle_rad
from usmbench.runs.dwells import dwell_begin
from usmbench.runs.record import Record

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_GAP = 1.5  # a step of the clock beyond so many windows is a break in the record
_RATE_TOLERANCE = 1e-3
_FEWEST_WINDOWS = 60
_NODES = 16_385
_LONGEST_START = 50
_MOST_WINDOWS = 40_000  # more add time and memory, and hardly power
_BLOCK = 2000
_FASTEST_RAD_S = 1e3  # beyond any step


class TabledCurve:
    """A static curve row by row, by linear interpolation in a fine table.

    Parameters
    ----------
    phase_deg
        Nodes, shape (K,).
    speed_rad_s
        Speeds at the nodes, one array a point.
    weights
        Weight of each point on each row, shape (N,) each.
    own_deg
        The rows' own phases, for which the curve is asked over and over, shape (N,).
    """

    def __init__(
        self,
        phase_deg: Array,
        speed_rad_s: Sequence[Array],
        weights: Sequence[Array],
        own_deg: Array,
    ):
        self._phase_deg, self._speed_rad_s, self._weights = phase_deg, speed_rad_s, weights
        self._own_deg, self._own_rad_s = own_deg, self._looked_up(own_deg)
        self._own_rad_s.flags.writeable = False

    def __call__(self, phase_deg: Array) -> Array:
        """Return the settled speed of each row.

        Parameters
        ----------
        phase_deg
            Phase of each row, shape (N,).
        """
        return self._own_rad_s if phase_deg is self._own_deg else self._looked_up(phase_deg)

    def _looked_up(self, phase_deg: Array) -> Array:
        parts = [
            w * np.interp(phase_deg, self._phase_deg, s)
            for w, s in zip(self._weights, self._speed_rad_s, strict=True)
        ]
        total: Array = sum(parts[1:], parts[0])
        return total


@dataclass(frozen=True, slots=True)
class Stretch:
    """Consecutive windows of one run; columns have shape (N,).

    Parameters
    ----------
    run
        Index of the run.
    name
        Its name.
    context
        What effects may know.
    speed_rad_s
        Measured speed.
    simulated_rad_s
        Free run of the model as given.
    settled_rad_s
        Its settled speed.
    lag
        Windows since the phase last changed.
    step_rad_s
        Change of the settled speed at that moment.
    direction
        +1 where φ last rose, -1 where it last fell, 0 before it moved.
    jump
        Number of the last jump and the windows since: the same on rows that repeat each other.
    use
        Rows to judge: inside the model's range and past the start.
    points
        Weight of each of the model's operating points.
    places
        Place among them in frequency and torque, as far as they differ, from -1 to 1.
    """

    run: int
    name: str
    context: Context
    speed_rad_s: Array
    simulated_rad_s: Array
    settled_rad_s: Array
    lag: NDArray[np.int64]
    step_rad_s: Array
    direction: Array
    jump: NDArray[np.int64]
    use: Mask
    points: tuple[Array, ...]
    places: tuple[Array, ...]

    @property
    def again(self) -> NDArray[np.int64]:
        """How many rows repeat each one, itself among them, shape (N,)."""
        counts: NDArray[np.int64] = np.bincount(self.jump)[self.jump]
        return counts

    @property
    def residual_rad_s(self) -> Array:
        """Measured less simulated speed."""
        return self.speed_rad_s - self.simulated_rad_s


def cut_runs(
    records: Sequence[Record], model: HammersteinModel, effects: Sequence[Applied]
) -> tuple[list[Stretch], list[str]]:
    """Cut runs into stretches.

    Parameters
    ----------
    records
        The runs.
    model
        The model.
    effects
        The model's own effects.

    Returns
    -------
    stretches, warnings
        In the order of runs and time, and what the user ought to know.

    Raises
    ------
    InputError
        Runs that do not belong to the model, or too short to say anything.
    """
    nodes_deg = np.linspace(-200.0, 200.0, _NODES)
    speeds = [point.curve.speed_rad_s(nodes_deg) for point in model.points]
    stretches: list[Stretch] = []
    warnings: list[str] = []
    _check_motors(records)
    keep = min(1.0, _MOST_WINDOWS / sum(record.t_s.size for record in records))
    for run, record in enumerate(records):
        _check(record, model)
        angle_rad = middle_angle_rad(record)
        weights, outside = point_weights(
            model.points, record.t_s.size, record.frequency_hz, record.torque_nm
        )
        slopes = detuning_weights(model.points, weights)
        outside |= _beyond(model, weights, record.phase_deg)
        _check_outside(record, outside, warnings)
        window_s = float(np.median(record.window_s))
        jumps = np.flatnonzero(np.diff(record.t_s) > _GAP * window_s) + 1
        for rows in _pieces(record.t_s.size, jumps, keep):
            phase_deg, points = record.phase_deg[rows], tuple(w[rows] for w in weights)
            context = Context(
                record.t_s[rows],
                window_s,
                phase_deg,
                TabledCurve(nodes_deg, speeds, points, phase_deg),
                model.linear,
                angle_rad[rows],
                None if record.temperature_c is None else record.temperature_c[rows],
                None
                if slopes is None
                else TabledCurve(nodes_deg, speeds, [w[rows] for w in slopes], phase_deg),
                None if record.count_rad is None else record.count_rad / window_s,
            )
            measured_rad_s, use = record.speed_rad_s[rows], ~outside[rows]
            at = (points, places_among(model.points, points))
            stretches.append(_stretch(run, record.name, context, measured_rad_s, effects, use, at))
    if sum(int(np.count_nonzero(s.use)) for s in stretches) < _FEWEST_WINDOWS:
        raise InputError(
            f"{records[0].name}: fewer than {_FEWEST_WINDOWS} usable windows say nothing about "
            "causes; measure for longer"
        )
    return stretches, warnings


def first_windows(stretches: Sequence[Stretch], most: int) -> list[Stretch]:
    """Return the first stretches up to a number of windows, at least one.

    Parameters
    ----------
    stretches
        The stretches, at least one.
    most
        Windows at most, unless the first has more.
    """
    kept = [stretches[0]]
    for stretch in stretches[1:]:
        if sum(s.context.n for s in kept) + stretch.context.n <= most:
            kept.append(stretch)
    return kept


def _pieces(n: int, jumps: NDArray[np.int64], keep: float) -> list[NDArray[np.int64]]:
    """Rows of the stretches; of a very long run blocks spread evenly over it."""
    stretches = np.split(np.arange(n), jumps)
    if keep >= 1.0:
        return [rows for rows in stretches if rows.size > _LONGEST_START]
    pieces = []
    for rows in stretches:
        count = max(1, round(keep * rows.size / _BLOCK))
        for block in np.array_split(rows, count):
            middle = (block.size - min(_BLOCK, block.size)) // 2
            pieces.append(block[middle : middle + _BLOCK])
    return pieces


def _stretch(
    run: int,
    name: str,
    context: Context,
    speed_rad_s: Array,
    effects: Sequence[Applied],
    use: Mask,
    at: tuple[tuple[Array, ...], tuple[Array, ...]],
) -> Stretch:
    """Simulate a stretch and work out where each row stands after the last command."""
    simulated = extended_run(effects, context)
    rows, last = np.arange(context.n), dwell_begin(context.phase_deg)
    jump_rad_s = np.diff(simulated.settled_rad_s, prepend=simulated.settled_rad_s[:1])
    lag, step_rad_s = rows - last, jump_rad_s[last]
    # The model is no better where it still remembers how it started, or phases it does not know.
    unknown = np.maximum.accumulate(np.where(use, -1, rows))
    memory = min(memory_windows(context.linear) + 3, _LONGEST_START)
    return Stretch(
        run,
        name,
        context,
        speed_rad_s,
        simulated.speed_rad_s,
        simulated.settled_rad_s,
        lag,
        step_rad_s,
        np.sign(np.diff(context.phase_deg, prepend=context.phase_deg[:1]))[last],
        _jump(simulated.settled_rad_s, step_rad_s, lag),
        rows - unknown > memory,
        *at,
    )


def _jump(settled_rad_s: Array, step_rad_s: Array, lag: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return a number for what came before each row; a plan that repeats it errs the same way."""
    # One complex key sorts many times as fast as rows of three numbers.
    key = settled_rad_s + 1j * (step_rad_s + _FASTEST_RAD_S * lag)
    _, numbers = np.unique(np.round(key, 6), return_inverse=True)
    return np.asarray(numbers, dtype=np.int64)


def _beyond(model: HammersteinModel, weights: Sequence[Array], phase_deg: Array) -> Mask:
    """Rows whose phase lies beyond the range of a point that counts there."""
    beyond = np.zeros(phase_deg.size, dtype=np.bool_)
    for point, weight in zip(model.points, weights, strict=True):
        low_deg, high_deg = point.phase_range_deg
        beyond |= (weight != 0.0) & ((phase_deg < low_deg) | (phase_deg > high_deg))
    return beyond


def _check(record: Record, model: HammersteinModel) -> None:
    """Refuse numbers that are none, and windows of another length."""
    for column in ("t_s", "phase_deg", "speed_rad_s"):
        values = getattr(record, column)
        if not np.all(np.isfinite(values)):
            row = int(np.argmin(np.isfinite(values)))
            raise InputError(f"{record.name}: {column} of row {row} is no number; mend the row")
    if record.t_s.size < _FEWEST_WINDOWS:
        raise InputError(
            f"{record.name}: {record.t_s.size} windows say nothing about causes; measure at least "
            f"{_FEWEST_WINDOWS}"
        )
    window_s, model_s = float(np.median(record.window_s)), model.linear.window_s
    if model_s is not None and abs(window_s / model_s - 1.0) > _RATE_TOLERANCE:
        raise InputError(
            f"{record.name} has windows of {1e3 * window_s:g} ms, the model was identified on "
            f"{1e3 * model_s:g} ms; identify it on a run with the same windows"
        )


def _check_motors(records: Sequence[Record]) -> None:
    """Refuse runs of different motors."""
    motors = {str(r.meta["motor"]): r.name for r in records if r.meta.get("motor") is not None}
    if len(motors) > 1:
        said = "; ".join(f"{name} is of {motor}" for motor, name in motors.items())
        raise InputError(f"these runs do not belong together: {said}; diagnose one motor at a time")


def _check_outside(record: Record, outside: Mask, warnings: list[str]) -> None:
    """Refuse a run mostly outside the model's range; warn of a few rows."""
    share = float(np.mean(outside))
    if share > 0.5:
        raise InputError(
            f"{record.name}: {100.0 * share:.0f} % of the rows lie outside the phases, frequencies "
            "or torques that the model was identified on; diagnose a run within them, or identify "
            "a model on a run like this one"
        )
    if share > 0.0:
        warnings.append(
            f"{record.name}: {np.count_nonzero(outside)} rows lie outside the model's range and "
            "are not judged"
        )
