"""Marks are missing at one place of the encoder's disc."""

from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar

import numpy as np

from usmbench.model.effects.base import Array, Mask, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.lone_windows import LoneWindows, SporadicEffect, Weighed
from usmbench.model.effects.parameter import Parameter
from usmbench.model.effects.place_on_disc import (
    TURN_RAD,
    Place,
    passed,
    places,
    spares_slow_ones,
)

_BESIDE = 0.25  # of the missing angle: while it passes, the counter stands, to a count or so


class DamagedDisc(SporadicEffect):
    """No counts while δ of the revolution passes: marks are missing there, or covered.

    Both ways the same counts are missing, so a revolution has 2π − δ by what is counted, and the
    place keeps its angle by these counts.
    """

    name = "damaged_disc"
    meaning = "At one place of the encoder's disc counts are missing, each time that it passes."
    mend = "Look at the disc at this angle for dirt or a scratch; clean it, or change the disc."
    left_out = True
    sizes = ("missing_rad",)  # angles may begin anew
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "rate_hz", "1/s", 0.0, 0.0, 100.0, 0.1, what="windows in which it passes, per second"
        ),
        Parameter(
            "missing_rad",
            "rad",
            0.0,
            0.0,
            TURN_RAD,
            0.01,
            what="angle that is not counted there, in the same run",
        ),
        Parameter(
            "angle_rad",
            "rad",
            0.0,
            0.0,
            TURN_RAD,
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
        half_rad, from_place_rad = 0.5 * signal * window_s, context.turned_rad(signal)
        from_place_rad = from_place_rad - values["angle_rad"]
        ends_rad = np.stack([from_place_rad - half_rad, from_place_rad + half_rad])
        turns, within_rad = np.divmod(ends_rad, TURN_RAD)
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
        found = places(windows)
        own = ((windows.of(windows.run == run), place) for run, place in found.items())
        if not found or any(spares_slow_ones(*pair) for pair in own):
            return Weighed(-np.inf, {})
        first = next(iter(found.values()))
        struck = replace(windows, alone=windows.alone & _struck(windows, found))
        values = {
            "rate_hz": struck.rate_hz(np.ones(struck.alone.size, dtype=np.bool_)),
            "missing_rad": first.missing_rad,
            "angle_rad": first.angle_rad,
        }
        return Weighed(sum(place.log_likelihood for place in found.values()), values)

    def lacks_rad(self, values: Values) -> float:
        """Return what is missing.

        Parameters
        ----------
        values
            As in `SporadicEffect.lacks_rad`.
        """
        return values["missing_rad"]

    def shown_against(self, windows: LoneWindows) -> tuple[str, Array]:
        """Return the shaft's angle from where marks are missing, half a revolution either way.

        Parameters
        ----------
        windows
            As in `SporadicEffect.shown_against`.
        """
        away_rad = np.zeros(windows.alone.size)
        for run, place in places(windows).items():
            rows = windows.run == run
            turned_rad = 0.5 * (windows.from_rad + windows.to_rad)[rows] - place.angle_rad[1]
            away_rad[rows] = np.remainder(turned_rad, place.turn_rad)
            away_rad[rows] -= place.turn_rad * (away_rad[rows] > 0.5 * place.turn_rad)
        return "shaft angle from the gap (rad)", away_rad

    def touched(self, windows: LoneWindows, every: LoneWindows) -> Mask:
        """Return the windows in which the place passes, also where they do not stand alone.

        Parameters
        ----------
        windows, every
            As in `SporadicEffect.touched`.
        """
        return _struck(every, places(windows))


def _struck(windows: LoneWindows, found: Mapping[int, Place]) -> Mask:
    """Return the windows that hold a part of the place of their run, shape (N,)."""
    rows = np.zeros(windows.alone.size, dtype=np.bool_)
    for run, place in found.items():
        beside_rad = _BESIDE * place.missing_rad[1]
        rows |= (windows.run == run) & passed(windows, place, beside_rad)
    return rows


FORMS = (DamagedDisc(),)
