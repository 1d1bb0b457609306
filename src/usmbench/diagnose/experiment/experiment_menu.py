"""The plans from which the next experiment is chosen: of one length, and unlike each other."""

import math
from collections.abc import Iterator

import numpy as np

from usmbench.diagnose.cutting.check_runs import FEWEST_WINDOWS
from usmbench.diagnose.experiment.experiment_range import Range
from usmbench.diagnose.experiment.proposal import Document, Experiment

DURATION_S = 30.0
_WINDOWS = 6 * FEWEST_WINDOWS  # at least, as some are at starts; nothing measured sets it
_SHORTEST_DWELL = 4
_LEVELS = 9
_SEED = 1
_STAIRS = 24


def menu(where: Range) -> tuple[Experiment, ...]:
    """Return the experiments to choose from, each about 30 s of drive at a load torque.

    Longer where so few long windows would say nothing.

    Parameters
    ----------
    where
        Where they may go.
    """
    return tuple(
        Experiment(says, {**_head(where), **body})
        for says, body in (*_passes(where), *_free(where))
    )


def _duration_s(where: Range) -> float:
    return max(DURATION_S, _WINDOWS * where.window_s)


def _head(where: Range) -> Document:
    return {
        "format": "usmbench-plan/1",
        "name": "next-experiment",
        "frequency_hz": where.frequency_hz[0],
        "torque_nm": where.torque_nm[0],
    }


def _passes(where: Range) -> Iterator[tuple[str, Document]]:
    """Yield rates, directions, dwells, the dead zone, loads and frequencies."""
    windows = round(_duration_s(where) / where.window_s)
    even = _even(where.low_deg, where.high_deg, _STAIRS)
    both = {"phase_deg": even, "direction": "both"}
    slow = _dwell(windows // (2 * len(even)))
    yield "a slow staircase, up and down", {"passes": [both], "dwell": slow}
    yield _fast_staircase(both, windows)
    yield _triangles(where, windows)
    one_way = [{"phase_deg": even, "direction": "rising", "repeats": 2}]
    yield "a staircase that only rises, twice", {"passes": one_way, "dwell": slow}
    yield _held_long(where, windows)
    yield from _dead_zone(where, windows)
    yield from _loads(where, {"passes": [both], "dwell": slow})
    half = _dwell(windows // (4 * len(even)))
    yield from _frequencies(where, {"passes": [both], "dwell": half})


def _fast_staircase(both: Document, windows: int) -> tuple[str, Document]:
    """Return a staircase, up and down, of dwells an eighth as long, repeated."""
    stairs = len(both["phase_deg"])
    dwell = _dwell(windows // (16 * stairs))
    repeats = max(round(windows / (2 * stairs * dwell["windows"])), 1)
    says = "the same staircase, far faster and repeated"
    return says, {"passes": [{**both, "repeats": repeats}], "dwell": dwell}


def _triangles(where: Range, windows: int) -> tuple[str, Document]:
    """Return triangles of fine steps and of steps four times as high."""
    steps = windows // (4 * _SHORTEST_DWELL)
    fine, coarse = (_even(where.low_deg, where.high_deg, max(n, 2)) for n in (steps, steps // 4))
    two = [
        {"phase_deg": fine, "direction": "both"},
        {"phase_deg": coarse, "direction": "both", "repeats": 4},
    ]
    return "triangles at two rates, 1 to 4", {"passes": two, "dwell": _dwell(_SHORTEST_DWELL)}


def _held_long(where: Range, windows: int) -> tuple[str, Document]:
    """Return five phases, each long enough to show a drift."""
    few = _even(where.low_deg, where.high_deg, 5)
    passes = [{"phase_deg": few, "direction": "both"}]
    says = "a few phases held long, up and down"
    return says, {"passes": passes, "dwell": _dwell(windows // (2 * len(few)))}


def _dead_zone(where: Range, windows: int) -> Iterator[tuple[str, Document]]:
    """Yield small steps through the dead zone, where it is within reach."""
    low_deg, high_deg = where.dead_zone_deg
    reach_deg = 1.5 * max(high_deg - low_deg, 2.0)
    low_deg = max(where.low_deg, low_deg - reach_deg)
    high_deg = min(where.high_deg, high_deg + reach_deg)
    if low_deg < high_deg:
        near = {"phase_deg": _even(low_deg, high_deg, _STAIRS), "direction": "both", "repeats": 2}
        says = "small steps through the dead zone, to and fro"
        yield says, {"passes": [near], "dwell": _dwell(windows // (4 * _STAIRS))}


def _loads(where: Range, staircase: Document) -> Iterator[tuple[str, Document]]:
    """Yield a staircase at all load torques, where there are several."""
    if len(where.torque_nm) > 1:
        torques_nm = sorted(where.torque_nm)
        says = f"the slow staircase at {len(torques_nm)} load torques"
        yield says, {**staircase, "torque_nm": torques_nm, "load": "operator"}


def _frequencies(where: Range, staircase: Document) -> Iterator[tuple[str, Document]]:
    """Yield a staircase at two drive frequencies, the runs' own and each other one."""
    here_hz, *others_hz = where.frequency_hz
    for other_hz in others_hz:
        says = f"a staircase, up and down, at {here_hz:g} Hz and at {other_hz:g} Hz"
        yield says, {**staircase, "frequency_hz": [here_hz, other_hz]}


def _free(where: Range) -> Iterator[tuple[str, Document]]:
    """Yield free excitations."""
    centre_deg = round(0.5 * (where.low_deg + where.high_deg), 3)
    reach_deg = min(where.high_deg - centre_deg, centre_deg - where.low_deg)
    shared = {
        "seed": _SEED,
        "centre_deg": centre_deg,
        # Rounded down: the phases must stay where the model is known.
        "amplitude_deg": math.floor(1000.0 * reach_deg) / 1000.0,
        "duration_s": _duration_s(where),
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
        if band[1] * _duration_s(where) < 1.0:
            continue  # no whole wave fits into the run
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
