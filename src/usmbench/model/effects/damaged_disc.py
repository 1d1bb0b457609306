"""Marks are missing at one place of the encoder's disc."""

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from scipy.special import xlogy

from usmbench.model.effects.base import Array, Mask, Values
from usmbench.model.effects.context import Context, middle_rad
from usmbench.model.effects.lone_windows import Interval, LoneWindows, SporadicEffect, Weighed
from usmbench.model.effects.parameter import Parameter

_TURN_RAD = 2.0 * math.pi
_PLACES = 5  # tried in each window that stands alone
# Times what is missing: slower windows may share it. Of the faster ones those that a limit would
# spare; nothing measured sets it.
_TIMES, _SLOWER = 2.0, 0.25
_STANDS = 0.1  # of the missing angle: by which a counter that stands may move
_BESIDE = 0.25  # of the missing angle: while it passes, the counter stands, to a count or so
_AS_LIKELY = 1.92  # of the log-likelihood: 95 % of χ² with one degree of freedom, halved
_OTHERWISE = 0.02  # of the windows that stand alone: elsewhere, or too fast. As for lost counts


class DamagedDisc(SporadicEffect):
    """No counts while δ of the revolution passes: marks are missing there, or covered.

    Both ways the same counts are missing, so a revolution has 2π − δ by what is counted, and the
    place keeps its angle by these counts.
    """

    name = "damaged_disc"
    meaning = "At one place of the encoder's disc counts are missing, each time that it passes."
    mend = "Look at the disc at this angle for dirt or a scratch; clean it, or change the disc."
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "rate_hz", "1/s", 0.0, 0.0, 100.0, 0.1, what="windows in which it passes, per second"
        ),
        Parameter(
            "missing_rad",
            "rad",
            0.0,
            0.0,
            _TURN_RAD,
            0.01,
            what="angle that is not counted there, in the same run",
        ),
        Parameter(
            "angle_rad",
            "rad",
            0.0,
            0.0,
            _TURN_RAD,
            1.0,
            what="where it is, by the angle that the first run that shows it reports",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        missing_rad, window_s = values["missing_rad"], context.window_s
        half_rad, middle = 0.5 * signal * window_s, context.angle_rad
        if middle is None:
            middle = middle_rad(signal, window_s)
        ends_rad = np.stack([middle - half_rad, middle + half_rad]) - values["angle_rad"]
        turns, within_rad = np.divmod(ends_rad, _TURN_RAD)
        lost_rad = turns * missing_rad + np.minimum(within_rad, missing_rad)
        return np.asarray(signal - np.diff(lost_rad, axis=0)[0] / window_s)

    def weigh(self, windows: LoneWindows) -> Weighed:
        """Return how well missing marks fit: where one place passes, and always too slow.

        Each run is weighed by itself: angles may begin anew in it.

        Parameters
        ----------
        windows
            The windows, of which some stand alone.
        """
        places = _places(windows)
        own = ((windows.of(windows.run == run), place) for run, place in places.items())
        if not places or any(_spares_slow_ones(*pair) for pair in own):
            return Weighed(-np.inf, {})
        first = next(iter(places.values()))
        values = {
            "rate_hz": windows.rate_hz(np.ones(windows.alone.size, dtype=np.bool_)),
            "missing_rad": first.missing_rad,
            "angle_rad": first.angle_rad,
        }
        return Weighed(sum(place.log_likelihood for place in places.values()), values)

    def touched(self, windows: LoneWindows, every: LoneWindows) -> Mask:
        """Return the windows in which the place passes, also where they do not stand alone.

        Parameters
        ----------
        windows, every
            As in `SporadicEffect.touched`.
        """
        rows = np.zeros(every.alone.size, dtype=np.bool_)
        for run, place in _places(windows).items():
            beside_rad = _BESIDE * place.missing_rad[1]
            rows |= (every.run == run) & _passed(every, place, beside_rad)
        return rows


@dataclass(frozen=True, slots=True)
class _Place:
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


def _missing_rad(windows: LoneWindows) -> Interval:
    """Return what is missing: low end, median and high end of 95 %.

    Windows in a row that stand alone lack a part of one pass each.
    """
    lacks_rad_s = np.where(windows.alone, windows.deviation_rad_s, 0.0)
    row = np.cumsum(np.diff(windows.alone, prepend=False))
    whole_rad_s = np.bincount(row, lacks_rad_s)[row]
    every = np.ones(lacks_rad_s.size, dtype=np.bool_)
    sizes = replace(windows, deviation_rad_s=whole_rad_s).size_rad_s(every)
    low, size, high = (rad_s * windows.window_s for rad_s in sizes)
    return low, size, high


def _places(windows: LoneWindows) -> dict[int, _Place]:
    """Return the likeliest place in each run of which some windows stand alone."""
    found = {}
    for run in np.unique(windows.run[windows.alone]).tolist():
        own = windows.of(windows.run == run)
        missing_rad = _missing_rad(own)
        # Where an index corrects the count, a revolution has all of its angle.
        turns_rad = (_TURN_RAD - missing_rad[1], _TURN_RAD)
        both = (_placed(own, missing_rad, turn_rad) for turn_rad in turns_rad)
        found[run] = max(both, key=lambda place: place.log_likelihood)
    return found


def _passed(windows: LoneWindows, place: _Place, beside_rad: float) -> Mask:
    """Return the windows in which a place passes, or may by so much more angle."""
    low_rad, _, high_rad = place.angle_rad
    ends_rad = (windows.from_rad - high_rad - beside_rad, windows.to_rad - low_rad + beside_rad)
    first, last = (np.floor(end_rad / place.turn_rad) for end_rad in ends_rad)
    return np.asarray(last > first)


def _spares_slow_ones(run: LoneWindows, place: _Place) -> bool:
    """Whether most of the slower passes take nothing, of those that one window can hold.

    A filter that swallows the narrowest pulse of the disc does so at one place, above some speed.
    """
    _, missing_rad, _ = place.missing_rad
    fast_rad_s = np.abs(run.speed_rad_s)
    beside = _passed(run, place, missing_rad)
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
    return bool(np.mean(struck[slower]) < 0.5)


def _placed(run: LoneWindows, missing_rad: Interval, turn_rad: float) -> _Place:
    """Return the likeliest place in one run, with where its likelihood is near the largest.

    That interval is of Wilks (1938, doi:10.1214/aoms/1177732360).
    """
    inner = np.linspace(0.0, 1.0, _PLACES + 2)[1:-1, None]
    from_rad, to_rad = run.from_rad[run.alone], run.to_rad[run.alone]
    tried_rad = np.remainder(from_rad + inner * (to_rad - from_rad), turn_rad).ravel()
    likely = _log_likelihood(run, tried_rad, turn_rad)
    best = int(np.argmax(likely))
    away_rad = np.remainder(tried_rad - tried_rad[best] + 0.5 * turn_rad, turn_rad) - 0.5 * turn_rad
    as_well = away_rad[likely > likely[best] - _AS_LIKELY]
    place_rad, apart_rad = float(tried_rad[best]), float(np.median(to_rad - from_rad)) / _PLACES
    low_rad, high_rad = (float(end) for end in (np.min(as_well), np.max(as_well)))
    angle_rad = (place_rad + low_rad - apart_rad, place_rad, place_rad + high_rad + apart_rad)
    # Where it is was chosen to fit.
    likely_most = float(likely[best]) - math.log(run.alone.size)
    return _Place(likely_most, missing_rad, angle_rad, turn_rad)


def _log_likelihood(run: LoneWindows, places_rad: Array, turn_rad: float) -> Array:
    """Log-likelihood of which windows stand alone, if marks are missing at a place, by place.

    As many do as do; nearly all of these are among the windows in which the place passes.
    """
    slow = run.deviation_rad_s * np.sign(run.speed_rad_s) < 0.0
    every = np.ones(slow.size, dtype=np.bool_)
    pass_it, struck, slowed = (
        _passing(run.of(rows), places_rad, turn_rad)
        for rows in (every, run.alone, run.alone & slow)
    )
    n, count = slow.size, int(np.count_nonzero(run.alone))
    likely = (1.0 - _OTHERWISE) * n / np.maximum(pass_it, 1.0)
    unlikely = 0.5 * _OTHERWISE * n / np.maximum(n - pass_it, 1.0)
    at_chance = float(xlogy(count, count / n) + xlogy(n - count, 1.0 - count / n))
    ways = slowed * math.log(1.0 - _OTHERWISE) + (struck - slowed) * math.log(_OTHERWISE)
    return at_chance + ways + struck * np.log(likely) + (count - struck) * np.log(unlikely)


def _passing(windows: LoneWindows, places_rad: Array, turn_rad: float) -> Array:
    """Return in how many windows each place passes, shape of the places.

    While marks are missing, the counter stands.
    """
    beside_rad = _STANDS * (_TURN_RAD - turn_rad)
    begin = np.remainder(windows.from_rad - beside_rad, turn_rad)
    turned_rad = windows.to_rad - windows.from_rad + 2.0 * beside_rad
    end = np.sort(begin + np.minimum(turned_rad, turn_rad))
    begin = np.sort(begin)
    passing = np.zeros(places_rad.size)
    for at in (places_rad, places_rad + turn_rad):
        passing += np.searchsorted(begin, at, "right") - np.searchsorted(end, at, "right")
    return passing


FORMS = (DamagedDisc(),)
