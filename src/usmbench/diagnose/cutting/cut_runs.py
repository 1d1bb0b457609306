"""Runs cut into unbroken stretches."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.check_runs import check_enough, check_outside, check_run
from usmbench.diagnose.cutting.heating import heating
from usmbench.diagnose.cutting.stretches import Mask, Stretch, came_from, stepped
from usmbench.diagnose.cutting.tabled_curve import NODES_DEG, TabledCurve
from usmbench.model.applied import Applied
from usmbench.model.driving import driving_of, stops
from usmbench.model.effects.context import Context
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import HammersteinModel, LinearPart
from usmbench.model.linear import memory_windows
from usmbench.model.mixed_curve import beyond_range
from usmbench.model.operating_points import places_among, point_weights
from usmbench.model.replay import middle_angle_rad
from usmbench.model.resonance_slope import point_slopes
from usmbench.model.same_motor import another_motor
from usmbench.runs.check_record import changed_since_closed, check_together
from usmbench.runs.doubtful_units import doubtful_units
from usmbench.runs.dwells import dwell_begin
from usmbench.runs.record import Record
from usmbench.runs.shaft_angle import angle_warnings
from usmbench.runs.time_step import breaks

Array = NDArray[np.float64]

_LONGEST_START = 50
_MOST_STARTS = 5  # told apart in a run: more take time, and add up to a scatter
_MOST_WINDOWS = 40_000  # more add time and memory, and hardly power
_BLOCK, _LEAST_BLOCK = 1000, 400
_TURN = 0.618  # of the gap between blocks, from run to run: these fractions spread most evenly


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
    warnings = changed_since_closed(records)
    check_together(records)
    warnings += another_motor(records, model)
    for record in records:
        check_run(record, model)
    warnings += doubtful_units(records)
    sizes = [record.t_s.size for record in records]
    jumps = [breaks(record.t_s, record.usual_window_s) for record in records]
    keep = min(1.0, _MOST_WINDOWS / sum(sizes))
    pieces = _pieces(sizes, jumps, keep, _start_windows(model.linear))
    tabled = _Tabled.of(model)
    stretches: list[Stretch] = []
    for run, (record, cut) in enumerate(zip(records, pieces, strict=True)):
        warnings += angle_warnings(record)
        weights, outside = point_weights(
            model.points, record.t_s.size, record.frequency_hz, record.torque_nm
        )
        outside |= beyond_range(model.points, weights, record.phase_deg)
        check_outside(record, outside, warnings)
        usable = ~outside if record.driven is None else ~outside & record.driven
        commands = [c for c in (record.phase_deg, record.frequency_hz) if c is not None]
        warm = heating(record, weights, tabled.speeds_rad_s, cut)
        paused = stops(record.t_s, record.usual_window_s, record.driven)
        contexts = tabled.contexts(record, weights, cut)
        for rows, context, (warmed, unsure) in zip(cut, contexts, warm, strict=True):
            points = tuple(w[rows] for w in weights)
            at = (points, places_among(model.points, points), warmed)
            measured_rad_s, use = record.speed_rad_s[rows], usable[rows]
            begin = dwell_begin(*(c[rows] for c in commands))
            stretch = _stretch(run, record.name, context, measured_rad_s, effects, use, begin, at)
            start = min(int(np.searchsorted(paused, rows[0], side="right")), _MOST_STARTS)
            stretches.append(replace(stretch, unsure_warmth=unsure, start=start))
    check_enough(records, sum(int(np.count_nonzero(s.use)) for s in stretches))
    return stretches, warnings


@dataclass(frozen=True, slots=True)
class _Tabled:
    """A model's curves, tabled."""

    model: HammersteinModel
    speeds_rad_s: list[Array]
    slopes_rad_s: list[Array] | None

    @classmethod
    def of(cls, model: HammersteinModel) -> "_Tabled":
        """Return a model's tables."""
        speeds_rad_s = [point.curve.speed_rad_s(NODES_DEG) for point in model.points]
        along = point_slopes(model.points)
        slopes_rad_s = None if along is None else [slope.rad_s(NODES_DEG) for slope in along]
        return cls(model, speeds_rad_s, slopes_rad_s)

    def contexts(
        self, record: Record, weights: Sequence[Array], cut: Sequence[NDArray[np.int64]]
    ) -> Iterator[Context]:
        """Yield what effects may know of each stretch of a run."""
        window_s, driven = record.usual_window_s, driving_of(record)
        angle_rad, count_rad = middle_angle_rad(record), record.count_rad
        for rows in cut:
            phase_deg, points = record.phase_deg[rows], tuple(w[rows] for w in weights)
            slopes = self.slopes_rad_s
            yield Context(
                record.t_s[rows],
                window_s,
                phase_deg,
                TabledCurve(self.speeds_rad_s, points, phase_deg),
                self.model.linear,
                angle_rad[rows],
                None if slopes is None else TabledCurve(slopes, points, phase_deg),
                None if count_rad is None else count_rad / window_s,
                record.phase_step_deg,
                driven,
            )


def _pieces(
    sizes: Sequence[int], jumps: Sequence[NDArray[np.int64]], keep: float, start: int
) -> list[list[NDArray[np.int64]]]:
    """Rows of each run's stretches; of very many, blocks spread evenly over them, ends and all.

    Those of another run lie between: together they show how a motor warms without a gap. What is no
    longer than its start says nothing.
    """
    least = start if keep == 1.0 else _LONGEST_START
    every: list[list[NDArray[np.int64]]] = []
    owed = 0.0
    for run, (n, at) in enumerate(zip(sizes, jumps, strict=True)):
        every.append([])
        for rows in np.split(np.arange(n), at):
            owed += keep * rows.size
            here = min(owed, rows.size)  # the rest is for the next ones
            count = max(1, round(here / _BLOCK)) if keep < 1.0 else 1
            size = min(round(here / count), rows.size // count) if keep < 1.0 else rows.size
            if size <= least or size < min(_LEAST_BLOCK, rows.size):
                continue  # the next ones give more
            owed -= count * size
            begins = _begins(rows.size, count, size, run * _TURN % 1.0)
            every[-1] += [rows[begin : begin + size] for begin in begins]
    return every


def _begins(n: int, count: int, size: int, turn: float) -> list[int]:
    """Where blocks begin: the first and the last at the ends, the others by a turn in the gaps."""
    between = max(count - 2, 0)
    gap = max(n - count * size, 0) / max(between, 1)
    inner = size + np.arange(between) * (size + gap) + turn * gap
    return [int(begin) for begin in (0, *inner, n - size)][:count]


def _start_windows(linear: LinearPart) -> int:
    """Windows at the start of a stretch in which the simulation remembers what came before."""
    return min(memory_windows(linear) + 3, _LONGEST_START)


def _stretch(
    run: int,
    name: str,
    context: Context,
    speed_rad_s: Array,
    effects: Sequence[Applied],
    use: Mask,
    begin: NDArray[np.int64],
    at: tuple[tuple[Array, ...], tuple[Array, ...], Array],
) -> Stretch:
    """Simulate a stretch and work out where each row stands after the last command."""
    simulated = extended_run(effects, context)
    rows = np.arange(context.n)
    lag, step_rad_s = rows - begin, stepped(simulated.settled_rad_s, begin)
    # The model is no better where it still remembers how it started, or phases it does not know.
    unknown = np.maximum.accumulate(np.where(use, -1, rows))
    return Stretch(
        run,
        name,
        context,
        speed_rad_s,
        simulated.speed_rad_s,
        simulated.settled_rad_s,
        lag,
        step_rad_s,
        np.sign(stepped(context.phase_deg, begin)),
        np.unique(came_from(simulated.settled_rad_s, step_rad_s, lag), return_inverse=True)[1],
        rows - unknown > _start_windows(context.linear),
        *at,
    )
