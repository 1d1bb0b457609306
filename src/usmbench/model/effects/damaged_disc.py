"""Marks are missing at one place of the encoder's disc."""

import math
from dataclasses import replace
from typing import ClassVar

import numpy as np
from scipy.special import xlogy

from usmbench.model.effects.base import Array, Values
from usmbench.model.effects.context import Context, middle_rad
from usmbench.model.effects.lone_windows import Interval, LoneWindows, SporadicEffect, Weighed
from usmbench.model.effects.parameter import Parameter

_TURN_RAD = 2.0 * math.pi
_PLACES = 5  # tried in each window that stands alone
_AS_LIKELY = 1.92  # of the log-likelihood: 95 % of χ² with one degree of freedom, halved
_OTHERWISE = 0.02  # of the windows that stand alone: elsewhere, or too fast. As for lost counts


class DamagedDisc(SporadicEffect):
    """No counts while δ of the revolution passes: marks are missing there, or covered.

    Both ways the same counts are missing, so a revolution has 2π − δ by what is counted, and the
    place keeps its angle by these counts. The simulation's own shaft starts at the angle 0.
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
            what="angle that is not counted there",
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
        half_rad, middle = 0.5 * signal * window_s, middle_rad(signal, window_s)
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
        if not windows.alone.any():
            return Weighed(-np.inf, {})
        every = np.ones(windows.alone.size, dtype=np.bool_)
        # A pass from one window into the next takes a part of each.
        missing_rad_s = np.convolve(windows.deviation_rad_s, np.ones(3), mode="same")
        sizes_rad_s = replace(windows, deviation_rad_s=missing_rad_s).size_rad_s(every)
        low, size, high = (rad_s * windows.window_s for rad_s in sizes_rad_s)
        # Where an index corrects the count, a revolution has all of its angle.
        turns_rad = (_TURN_RAD - size, _TURN_RAD)
        runs = [windows.of(windows.run == run) for run in np.unique(windows.run[windows.alone])]
        found = [max(_placed(run, turn_rad) for turn_rad in turns_rad) for run in runs]
        values = {
            "rate_hz": windows.rate_hz(every),
            "missing_rad": (low, size, high),
            "angle_rad": found[0][1],
        }
        return Weighed(sum(likely for likely, _ in found), values)


def _placed(run: LoneWindows, turn_rad: float) -> tuple[float, Interval]:
    """Return the log-likelihood of one run at the likeliest place, and the place.

    It has the interval in which its likelihood is near the largest (Wilks 1938,
    doi:10.1214/aoms/1177732360).

    Parameters
    ----------
    run
        Windows of a run, some of which stand alone.
    turn_rad
        What a revolution is by its angle.
    """
    inner = np.linspace(0.0, 1.0, _PLACES + 2)[1:-1, None]
    from_rad, to_rad = run.from_rad[run.alone], run.to_rad[run.alone]
    tried_rad = np.remainder(from_rad + inner * (to_rad - from_rad), turn_rad).ravel()
    likely = _log_likelihood(run, tried_rad, turn_rad)
    best = int(np.argmax(likely))
    away_rad = np.remainder(tried_rad - tried_rad[best] + 0.5 * turn_rad, turn_rad) - 0.5 * turn_rad
    as_well = away_rad[likely > likely[best] - _AS_LIKELY]
    place_rad = float(tried_rad[best])
    interval = place_rad + float(np.min(as_well)), place_rad, place_rad + float(np.max(as_well))
    # Where it is was chosen to fit.
    return float(likely[best]) - math.log(run.alone.size), interval


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
    """Return in how many windows each place passes, shape of the places."""
    begin = np.remainder(windows.from_rad, turn_rad)
    end = np.sort(begin + np.minimum(windows.to_rad - windows.from_rad, turn_rad))
    begin = np.sort(begin)
    passing = np.zeros(places_rad.size)
    for at in (places_rad, places_rad + turn_rad):
        passing += np.searchsorted(begin, at, "right") - np.searchsorted(end, at, "right")
    return passing


FORMS = (DamagedDisc(),)
