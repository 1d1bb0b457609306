"""Counts are lost above some speed."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from usmbench.model.effects.base import Array, Effect, Mask, Values
from usmbench.model.effects.context import Context, highest_settled_rad_s
from usmbench.model.effects.lone_windows import (
    AS_LIKELY,
    STRAY,
    LoneWindows,
    SporadicEffect,
    Weighed,
)
from usmbench.model.effects.parameter import Parameter

_MEANING = "The counter loses counts above some speed."
_MEND = (
    "Check the counter's filter and input rate, the encoder's supply, and its cable; where all "
    "above some speed is lost, also what may hold the speed or its range: a controller, a logger."
)
_THRESHOLD = Parameter(
    "above_rad_s",
    "rad/s",
    1.0,
    0.0,
    1e3,
    0.5,
    scanned=True,
    what="speed above which counts are lost",
)
_SEED = 19_360_404
_ALIKE = 9  # decimals of a speed in rad/s: levels of a staircase differ by rounding
_OTHERS = 101  # speeds, struck or not, at which losses may begin, from the least to the highest


class LostExcess(Effect):
    """|ω′| = |ω| − k(|ω| − ω₀) above ω₀: a counter that loses more the faster it must count."""

    name = "missed_counts"
    form = "of the excess"
    meaning = _MEANING
    mend = _MEND
    stage = "counter"
    by_chance = True
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "lost_of_excess",
            "1",
            0.0,
            0.0,
            30.0,
            0.05,
            what="share of what the speed is above that speed",
        ),
        _THRESHOLD,
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        fast = np.abs(signal)
        lost = values["lost_of_excess"] * np.maximum(fast - values["above_rad_s"], 0.0)
        slower: Array = np.sign(signal) * np.maximum(fast - lost, 0.0)
        return slower

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return thresholds within the upper part of the speeds.

        Parameters
        ----------
        contexts
            All stretches.
        """
        return {"above_rad_s": _thresholds_rad_s(contexts)}


class LostShare(LostExcess):
    """ω′ = (1 − s) ω above ω₀: every so many counts is missed once edges come too fast."""

    form = "of all"
    parameters = (
        Parameter(
            "share_lost", "1", 0.0, 0.0, 1.0, 0.05, what="share of all counts, above that speed"
        ),
        _THRESHOLD,
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        above = np.abs(signal) > values["above_rad_s"]
        return signal * np.where(above, 1.0 - values["share_lost"], 1.0)


class LostMoreAndMore(LostExcess):
    """ω′ = (1 − s min((|ω| − ω₀)/Δω, 1)) ω above ω₀: pulses of many widths, the narrow ones first.

    From ω₀ + Δω on the share lost is all of s.
    """

    form = "more and more"
    parameters = (
        Parameter("share_lost", "1", 0.0, 0.0, 1.0, 0.05, what="share of counts lost in the end"),
        _THRESHOLD,
        replace(
            _THRESHOLD,
            name="within_rad_s",
            what="how much faster than that the motor turns where all of this share is lost",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        excess_rad_s = np.abs(signal) - values["above_rad_s"]
        part = np.clip(excess_rad_s / max(values["within_rad_s"], 1e-9), 0.0, 1.0)
        return signal * (1.0 - values["share_lost"] * part)

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return thresholds within the upper part of the speeds, and how slowly losses grow.

        Parameters
        ----------
        contexts
            All stretches.
        """
        highest_rad_s = highest_settled_rad_s(contexts)
        return {
            "above_rad_s": highest_rad_s * np.linspace(0.25, 0.9, 14),
            "within_rad_s": highest_rad_s * np.array([0.1, 0.2, 0.4]),
        }


class LostNowAndThen(SporadicEffect):
    """Now and then a window above ω₀ loses counts: a filter or a cable at its limit."""

    name = "missed_counts"
    form = "now and then"
    sizes = ("lost_rad_s",)
    meaning = _MEANING
    mend = _MEND
    parameters = (
        Parameter(
            "rate_hz",
            "1/s",
            0.0,
            0.0,
            100.0,
            0.1,
            what="windows that lose counts, per second above that speed",
        ),
        Parameter(
            "lost_rad_s", "rad/s", 0.0, 0.0, 1e4, 1.0, what="speed that such a window lacks, median"
        ),
        Parameter(
            "above_rad_s", "rad/s", 0.0, 0.0, 1e3, 0.1, what="speed above which counts are lost"
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        draw = np.random.default_rng(_SEED)
        hit = self.struck(draw, context, values["rate_hz"])
        lost = hit & (np.abs(signal) > values["above_rad_s"])
        slower: Array = signal - values["lost_rad_s"] * np.sign(signal) * lost
        return slower

    def weigh(self, windows: LoneWindows) -> Weighed:
        """Return how well lost counts fit: only above some speed, and always too slow.

        That speed has the interval in which its likelihood is near the largest (Wilks 1938,
        doi:10.1214/aoms/1177732360).

        Parameters
        ----------
        windows
            The windows, of which some stand alone.
        """
        fast, alone = np.round(np.abs(windows.speed_rad_s), _ALIKE), windows.alone
        if not alone.any():
            return Weighed(-np.inf, {})
        # They begin at one that is struck, or as well at some that are slower.
        others = np.quantile(fast, np.linspace(0.0, 1.0, _OTHERS), method="nearest")
        slower = others[others < np.max(fast[alone])]
        begins = np.unique(np.r_[fast[alone], slower]).tolist()
        likely = np.array([_log_likelihood(windows, fast >= speed) for speed in begins])
        best = int(np.argmax(likely))
        as_well = np.flatnonzero(likely > likely[best] - AS_LIKELY)
        low, below = (
            float(np.max(fast[fast < begins[k]], initial=0.0)) for k in (as_well[0], best)
        )
        above = fast >= begins[best]
        values = {
            "rate_hz": windows.rate_hz(above),
            "lost_rad_s": windows.size_rad_s(above),
            "above_rad_s": (low, 0.5 * (below + begins[best]), begins[as_well[-1]]),
        }
        # Where they begin was chosen to fit.
        return Weighed(float(likely[best]) - math.log(fast.size), values)


def _log_likelihood(windows: LoneWindows, above: Mask) -> float:
    """Log-likelihood of the windows that stand alone, if these above some speed lose counts."""
    alone = windows.alone
    slow = windows.deviation_rad_s * np.sign(windows.speed_rad_s) < 0.0
    odds = np.mean(alone[above]) * np.where(above, 1.0, STRAY)
    way = np.where(above, np.where(slow, 1.0 - STRAY, STRAY), 0.5)
    return float(np.sum(np.log(odds * way)[alone]) + np.sum(np.log1p(-odds[~alone])))


def _thresholds_rad_s(contexts: Sequence[Context]) -> Array:
    """From a quarter of the highest speed to just below it."""
    shares = np.linspace(0.25, 0.98, 38)
    return np.asarray(highest_settled_rad_s(contexts) * shares, dtype=np.float64)


FORMS = (LostExcess(), LostShare(), LostMoreAndMore(), LostNowAndThen())
