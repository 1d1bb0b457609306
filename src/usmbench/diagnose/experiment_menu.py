"""The plans from which the next experiment is chosen: of one length, and unlike each other."""

import math
from collections.abc import Iterable, Iterator, Sequence
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

DURATION_S = 30.0
_SHORTEST_DWELL = 4
_LEVELS = 9
_SEED = 1
_STAIRS = 24
_DEAD_ZONE_DEG = (-5.0, 5.0)  # where the model knows of none


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


@dataclass(frozen=True, slots=True)
class Range:
    """Where an experiment may go.

    Parameters
    ----------
    low_deg, high_deg
        Lowest and highest phase.
    dead_zone_deg
        Lower and upper edge of the dead zone.
    window_s
        Duration of a window.
    frequency_hz, torque_nm
        Drive frequencies and load torques that the model knows, at least one each; where the runs
        were comes first.
    """

    low_deg: float
    high_deg: float
    dead_zone_deg: tuple[float, float]
    window_s: float
    frequency_hz: tuple[float, ...]
    torque_nm: tuple[float, ...]


def range_of(model: HammersteinModel, records: Sequence[Record]) -> Range | None:
    """Return where a model may be used; None where no drive frequency is known.

    Parameters
    ----------
    model
        The model.
    records
        Runs of the motor: what they drove comes first.
    """
    points = model.points
    frequencies_hz = _known((p.frequency_hz for p in points), [r.frequency_hz for r in records])
    if not frequencies_hz:
        return None
    low_deg = max(p.phase_range_deg[0] for p in points)
    high_deg = min(p.phase_range_deg[1] for p in points)
    zone = points[0].dead_zone_deg
    edges = tuple(
        default if edge is None else edge
        for edge, default in zip(zone, _DEAD_ZONE_DEG, strict=True)
    )
    return Range(
        low_deg,
        high_deg,
        (edges[0], edges[1]),
        float(np.median(records[0].window_s)),
        frequencies_hz,
        _known((p.torque_nm for p in points), [r.torque_nm for r in records]) or (0.0,),
    )


def _known(values: Iterable[float | None], columns: Sequence[Array | None]) -> tuple[float, ...]:
    """Return what the points know of a setting, nearest to the runs' first; else the runs' own."""
    known = sorted({value for value in values if value is not None})
    driven = [float(np.median(column)) for column in columns if column is not None]
    if not driven:
        return tuple(known)
    return tuple(sorted(known, key=lambda value: abs(value - driven[0]))) or (driven[0],)


def menu(where: Range) -> tuple[Experiment, ...]:
    """Return the experiments to choose from, each about 30 s of drive at a load torque.

    Parameters
    ----------
    where
        Where they may go.
    """
    return tuple(
        Experiment(says, {**_head(where), **body})
        for says, body in (*_passes(where), *_free(where))
    )


def _head(where: Range) -> Document:
    return {
        "format": "usmbench-plan/1",
        "name": "next-experiment",
        "frequency_hz": where.frequency_hz[0],
        "torque_nm": where.torque_nm[0],
    }


def _passes(where: Range) -> Iterator[tuple[str, Document]]:
    """Yield rates, directions, dwells, the dead zone, loads and frequencies."""
    windows = round(DURATION_S / where.window_s)
    even = _even(where.low_deg, where.high_deg, _STAIRS)
    slow = _dwell(max(windows // (2 * len(even)), _SHORTEST_DWELL))
    fast = max(windows // (16 * len(even)), _SHORTEST_DWELL)
    both = {"phase_deg": even, "direction": "both"}
    yield "a slow staircase, up and down", {"passes": [both], "dwell": slow}
    yield (
        "the same staircase, far faster and repeated",
        {
            "passes": [{**both, "repeats": max(windows // (2 * len(even) * fast), 1)}],
            "dwell": _dwell(fast),
        },
    )
    steps = windows // (4 * _SHORTEST_DWELL)
    fine, coarse = (_even(where.low_deg, where.high_deg, n) for n in (steps, max(steps // 4, 2)))
    two = [
        {"phase_deg": fine, "direction": "both"},
        {"phase_deg": coarse, "direction": "both", "repeats": 4},
    ]
    yield "triangles at two rates, 1 to 4", {"passes": two, "dwell": _dwell(_SHORTEST_DWELL)}
    one_way = [{"phase_deg": even, "direction": "rising", "repeats": 2}]
    yield "a staircase that only rises, twice", {"passes": one_way, "dwell": slow}
    yield "a few phases held long, up and down", _held_long(where, windows)
    low_deg, high_deg = where.dead_zone_deg
    reach_deg = 1.5 * max(high_deg - low_deg, 2.0)
    low_deg, high_deg = (
        max(where.low_deg, low_deg - reach_deg),
        min(where.high_deg, high_deg + reach_deg),
    )
    near = {"phase_deg": _even(low_deg, high_deg, _STAIRS), "direction": "both", "repeats": 2}
    yield (
        "small steps through the dead zone, to and fro",
        {"passes": [near], "dwell": _dwell(max(windows // (4 * _STAIRS), _SHORTEST_DWELL))},
    )
    if len(where.torque_nm) > 1:
        torques_nm = sorted(where.torque_nm)
        loads = {"torque_nm": torques_nm, "load": "operator"}
        says = f"the slow staircase at {len(torques_nm)} load torques"
        yield says, {"passes": [both], "dwell": slow, **loads}
    here_hz, *others_hz = where.frequency_hz
    half = _dwell(max(windows // (4 * len(even)), _SHORTEST_DWELL))
    for other_hz in others_hz:
        says = f"a staircase, up and down, at {here_hz:g} Hz and at {other_hz:g} Hz"
        yield says, {"passes": [both], "dwell": half, "frequency_hz": [here_hz, other_hz]}


def _held_long(where: Range, windows: int) -> Document:
    """Five phases, each long enough to show a drift."""
    few = _even(where.low_deg, where.high_deg, 5)
    return {
        "passes": [{"phase_deg": few, "direction": "both"}],
        "dwell": _dwell(windows // (2 * len(few))),
    }


def _free(where: Range) -> Iterator[tuple[str, Document]]:
    """Yield free excitations."""
    centre_deg = round(0.5 * (where.low_deg + where.high_deg), 3)
    reach_deg = min(where.high_deg - centre_deg, centre_deg - where.low_deg)
    shared = {
        "seed": _SEED,
        "centre_deg": centre_deg,
        # Rounded down: the phases must stay where the model is known.
        "amplitude_deg": math.floor(1000.0 * reach_deg) / 1000.0,
        "duration_s": DURATION_S,
    }
    telegraph = {**shared, "kind": "telegraph"}
    for hold in (5, 20):
        yield (
            f"a random telegraph between {_LEVELS} phases, held for {hold} windows at a time",
            {"excitation": {**telegraph, "levels": _LEVELS, "hold_windows": hold}},
        )
    yield (
        "a random telegraph between the two ends",
        {"excitation": {**telegraph, "levels": 2, "hold_windows": 10}},
    )
    highest_hz = 0.5 / (_SHORTEST_DWELL * where.window_s)
    for name, share in (("slow", 0.04), ("fast", 0.4)):
        band = [round(v * share * highest_hz, 6) for v in (0.02, 1.0)]
        multisine = {**shared, "kind": "multisine", "hold_windows": _SHORTEST_DWELL}
        yield (
            f"a {name} random-phase multisine, up to {band[1]:.3g} Hz",
            {"excitation": {**multisine, "band_hz": band}},
        )


def _even(low_deg: float, high_deg: float, n: int) -> list[float]:
    """Return phases evenly spaced, within the range though they are rounded."""
    inner = np.round(np.linspace(low_deg, high_deg, n), 3)
    return [float(phase_deg) for phase_deg in np.clip(inner, low_deg, high_deg)]


def _dwell(windows: int) -> Document:
    """Return dwells of just so many windows."""
    windows = max(windows, _SHORTEST_DWELL)
    return {
        "windows": windows,
        "extend_to_windows": windows,
        "settle": {"min_windows": 1, "over_windows": 2},
    }


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
