"""Where on an encoder's disc marks are missing, by the windows that stand alone."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import xlogy

from usmbench.model.effects.base import Array, Mask
from usmbench.model.effects.lone_windows import AS_LIKELY, STRAY, Interval, LoneWindows

TURN_RAD = 2.0 * math.pi
"""A revolution of the shaft."""
_TRIED = 5  # places in each window that stands alone
# Of the windows that stand alone, how many do elsewhere, by another cause; what parts of them lack
# less, of the sizes that are tried. Nothing measured sets these.
_ELSEWHERE, _SIZES = (STRAY, 0.1, 0.25, 0.5), (0.1, 0.3, 0.5, 0.7, 0.9)
_CHOSEN = len(_ELSEWHERE) * len(_SIZES) * (len(_SIZES) + 2)  # shares, sizes and turns
# Times what is missing: slower windows may share it. Of the faster ones those that a limit would
# spare. By how much of what is missing a counter that stands may move. Nothing measured sets them.
_TIMES, _SLOWER, _STANDS = 2.0, 0.25, 0.1


@dataclass(frozen=True, slots=True)
class Place:
    """Where marks are missing in one run.

    Parameters
    ----------
    log_likelihood
        Of the windows that stand alone, less the price of what was chosen to fit.
    missing_rad, angle_rad
        How much is missing, and where: low end, value and high end of 95 %.
    turn_rad
        What a revolution is by the run's angle.
    """

    log_likelihood: float
    missing_rad: Interval
    angle_rad: Interval
    turn_rad: float


def _lacking_rad(windows: LoneWindows) -> LoneWindows:
    """Return windows with what a whole pass lacks: in a row each lacks a part of one."""
    lacks_rad_s = np.where(windows.alone, windows.deviation_rad_s, 0.0)
    row = np.cumsum(np.diff(windows.alone, prepend=False))
    return replace(windows, deviation_rad_s=np.bincount(row, lacks_rad_s)[row])


def _missing_rad(windows: LoneWindows, rows: Mask) -> Interval:
    """Return what is missing in some windows: low end, median and high end of 95 %."""
    sizes_rad_s = _lacking_rad(replace(windows, alone=windows.alone & rows)).size_rad_s(rows)
    low, size, high = (rad_s * windows.window_s for rad_s in sizes_rad_s)
    return low, size, high


def places(windows: LoneWindows) -> dict[int, Place]:
    """Return the likeliest place in each run of which some windows stand alone.

    Parameters
    ----------
    windows
        The windows; angles may begin anew in each run.
    """
    runs = np.unique(windows.run[windows.alone]).tolist()
    return {run: _place(windows.of(windows.run == run)) for run in runs}


def _place(run: LoneWindows) -> Place:
    """Return the likeliest place in a run, of what the windows lack in which it passes."""
    sizes_rad = np.abs(_lacking_rad(run).deviation_rad_s[run.alone]) * run.window_s
    tried = np.unique(np.quantile(sizes_rad, _SIZES, method="nearest")).tolist()
    others = [run.lacks_rad] if run.lacks_rad > 0.0 else tried
    rough = max((_best_turn(run, (s, s, s), others) for s in tried), key=_likelihood)
    own = passed(run, rough, rough.missing_rad[1])
    return _best_turn(run, _missing_rad(run, own), others) if np.any(run.alone & own) else rough


def _best_turn(run: LoneWindows, missing_rad: Interval, others_rad: Sequence[float]) -> Place:
    """Return the likeliest place: a revolution may lack a second one too, or nothing.

    It has all of its angle where an index corrects the count.
    """
    turn_rad = TURN_RAD - missing_rad[1]
    turns_rad = (TURN_RAD, turn_rad, *(turn_rad - other_rad for other_rad in others_rad))
    return max((_placed(run, missing_rad, turn_rad) for turn_rad in turns_rad), key=_likelihood)


def _likelihood(place: Place) -> float:
    return place.log_likelihood


def passed(windows: LoneWindows, place: Place, beside_rad: float) -> Mask:
    """Return the windows in which a place passes, shape (N,).

    Parameters
    ----------
    windows
        The windows, of the place's run.
    place
        The place.
    beside_rad
        How much farther off it may be.
    """
    low_rad, _, high_rad = place.angle_rad
    ends_rad = (windows.from_rad - high_rad - beside_rad, windows.to_rad - low_rad + beside_rad)
    first, last = (np.floor(end_rad / place.turn_rad) for end_rad in ends_rad)
    return np.asarray(last > first)


def spares_slow_ones(run: LoneWindows, place: Place) -> bool:
    """Whether the slower passes take half as often as all, of those that one window can hold.

    A filter that swallows the narrowest pulse of the disc does so at one place, above some speed.
    Dirt may be read now and then, at any speed.

    Parameters
    ----------
    run
        The windows of a run.
    place
        Its place.
    """
    _, missing_rad, _ = place.missing_rad
    fast_rad_s = np.abs(run.speed_rad_s)
    beside = passed(run, place, missing_rad)
    begins = beside & ~np.concatenate([[False], beside[:-1]])
    rows = beside & (fast_rad_s * run.window_s > _TIMES * missing_rad)
    passes = np.cumsum(begins)[rows]
    lacks_rad = -run.deviation_rad_s * np.sign(run.speed_rad_s) * run.window_s
    taken_rad, n, speed_rad_s = (
        np.bincount(passes, weights) for weights in (lacks_rad[rows], None, fast_rad_s[rows])
    )
    speeds, struck = (speed_rad_s / np.maximum(n, 1))[n > 0], (taken_rad > 0.5 * missing_rad)[n > 0]
    if not speeds.size:
        return False
    slower = speeds <= np.quantile(speeds, _SLOWER)
    return bool(np.mean(struck[slower]) < 0.5 * np.mean(struck))


def _placed(run: LoneWindows, missing_rad: Interval, turn_rad: float) -> Place:
    """Return the likeliest place in one run, with where its likelihood is near the largest.

    That interval is of Wilks (1938, doi:10.1214/aoms/1177732360).
    """
    inner = np.linspace(0.0, 1.0, _TRIED + 2)[1:-1, None]
    from_rad, to_rad = run.from_rad[run.alone], run.to_rad[run.alone]
    tried_rad = np.remainder(from_rad + inner * (to_rad - from_rad), turn_rad).ravel()
    likely = _log_likelihood(run, tried_rad, turn_rad)
    best = int(np.argmax(likely))
    away_rad = np.remainder(tried_rad - tried_rad[best] + 0.5 * turn_rad, turn_rad) - 0.5 * turn_rad
    as_well = away_rad[likely > likely[best] - AS_LIKELY]
    place_rad, apart_rad = float(tried_rad[best]), float(np.median(to_rad - from_rad)) / _TRIED
    low_rad, high_rad = (float(end) for end in (np.min(as_well), np.max(as_well)))
    angle_rad = (place_rad + low_rad - apart_rad, place_rad, place_rad + high_rad + apart_rad)
    # Where it is was chosen to fit, and so were the turn and how many windows it has no part in.
    likely_most = float(likely[best]) - math.log(run.alone.size * _CHOSEN)
    return Place(likely_most, missing_rad, angle_rad, turn_rad)


def _log_likelihood(run: LoneWindows, places_rad: Array, turn_rad: float) -> Array:
    """Log-likelihood of which windows stand alone, if marks are missing at a place, by place.

    As many do as do; of these most are among the windows in which the place passes.
    """
    slow = run.deviation_rad_s * np.sign(run.speed_rad_s) < 0.0
    every = np.ones(slow.size, dtype=np.bool_)
    pass_it, struck, slowed = (
        _passing(run.of(rows), places_rad, turn_rad)
        for rows in (every, run.alone, run.alone & slow)
    )
    n, count = slow.size, int(np.count_nonzero(run.alone))
    at_chance = float(xlogy(count, count / n) + xlogy(n - count, 1.0 - count / n))
    ways = slowed * math.log(1.0 - STRAY) + (struck - slowed) * math.log(STRAY)
    inside, outside = n / np.maximum(pass_it, 1.0), 0.5 * n / np.maximum(n - pass_it, 1.0)
    where = [
        struck * np.log((1.0 - elsewhere) * inside) + (count - struck) * np.log(elsewhere * outside)
        for elsewhere in _ELSEWHERE
    ]
    return np.asarray(at_chance + ways + np.max(where, axis=0))


def _passing(windows: LoneWindows, places_rad: Array, turn_rad: float) -> Array:
    """Return in how many windows each place passes, shape of the places.

    While marks are missing, the counter stands.
    """
    beside_rad = _STANDS * (TURN_RAD - turn_rad)
    begin = np.remainder(windows.from_rad - beside_rad, turn_rad)
    turned_rad = windows.to_rad - windows.from_rad + 2.0 * beside_rad
    end = np.sort(begin + np.minimum(turned_rad, turn_rad))
    begin = np.sort(begin)
    passing = np.zeros(places_rad.size)
    for at in (places_rad, places_rad + turn_rad):
        passing += np.searchsorted(begin, at, "right") - np.searchsorted(end, at, "right")
    return passing
