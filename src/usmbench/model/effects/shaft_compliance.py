"""A soft shaft or coupling: between motor and disc, or between both and a load that swings."""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import ClassVar

import numpy as np
from scipy.signal import lfilter

from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import Lag, lag_of
from usmbench.model.effects.parameter import Parameter
from usmbench.model.linear import time_constant_s
from usmbench.model.window_filter import Filter, behind_lag

_KEPT = 1024  # filters: one serves all stretches of a run, and many runs with the same values
_REST = 0.01  # of the highest speed
_SHORTEST = 2.0  # windows a period: what swings faster looks like any ripple
_MEND = "Tighten or stiffen the coupling between motor and disc; look for a cracked helix."
_SHAPE = (
    Parameter(
        "period_s",
        "s",
        0.0,
        0.0,
        0.5,
        0.003,
        scanned=True,
        least_windows=_SHORTEST,
        what="period of the ringing, undamped",
    ),
    Parameter(
        "damping", "1", 0.1, 0.01, 0.8, 0.05, scanned=True, what="damping ratio ζ of the ringing"
    ),
)


class ShaftCompliance(Effect):
    """The disc follows the rotor as ω_n²/(s² + 2ζω_n s + ω_n²): it rings after every step.

    Its bearing damps it. The disc's speed is averaged over each window, as the counter does; the
    rotor's follows with the model's lag in between, or, where that is of a higher order, is held.
    """

    _by_coupling: ClassVar[bool] = False  # damped

    name = "shaft_compliance"
    meaning = "The shaft or its coupling twists: the disc rings after the rotor changes speed."
    mend = _MEND
    stage = "motion"
    parameters: ClassVar[tuple[Parameter, ...]] = _SHAPE

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the disc's speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        if values["period_s"] < _SHORTEST * context.window_s:
            return signal
        shape = (values["period_s"], values["damping"], context.window_s)
        ringing = _ringing(_lag(context), *shape, by_coupling=self._by_coupling)
        return np.asarray(signal[0] + lfilter(*ringing, signal - signal[0]))

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return periods from the shortest that windows show to thirty of them.

        Parameters
        ----------
        contexts
            All stretches.
        """
        periods_s = contexts[0].window_s * np.geomspace(_SHORTEST, 30.0, 11)
        return {
            "period_s": np.minimum(periods_s, 0.5),
            "damping": np.array([0.03, 0.12, 0.4]),
        }


class DampedCoupling(ShaftCompliance):
    """The disc follows the rotor as (2ζω_n s + ω_n²)/(s² + 2ζω_n s + ω_n²).

    What damps it is the coupling, which pulls by the difference of the speeds: a disc that it
    damps well starts sooner than one that drags in its bearing.
    """

    _by_coupling = True

    form = "damped in the coupling"
    meaning = "The coupling twists, and damps what it lets ring."


def _lag(context: Context) -> Lag:
    """How the rotor follows, as far as it is known; at once for not at all."""
    tau_s = time_constant_s(context.linear) or 0.0
    return lag_of(context.linear, context.window_s) or Lag(tau_s, 0.0)


@lru_cache(_KEPT)
def _ringing(
    lag: Lag, period_s: float, damping: float, window_s: float, *, by_coupling: bool
) -> Filter:
    """Filter from the rotor's speed to the disc's, window by window."""
    swing = _swing(period_s, damping)
    return behind_lag(swing[1 if by_coupling else 2 :], swing, lag, window_s)


@lru_cache(_KEPT)
def _swinging(
    load_share: float, lag: Lag, period_s: float, damping: float, window_s: float
) -> Filter:
    """Filter from the rotor's speed to what a swinging load takes from it."""
    swing = _swing(period_s, damping)
    pull = load_share * lag.tau_s * np.array([swing[1], swing[2], 0.0])
    both = np.convolve(swing, [lag.tau_s, 1.0])
    both[1:] += pull
    return behind_lag(pull, both, lag, window_s)


def _swing(period_s: float, damping: float) -> Array:
    """Characteristic polynomial s² + 2ζω_n s + ω_n²."""
    natural_rad_s = 2.0 * math.pi / period_s
    return np.array([1.0, 2.0 * damping * natural_rad_s, natural_rad_s**2])


class SwingingLoad(ShaftCompliance):
    """Behind a soft coupling hangs a load of `load_share` of the motor's moment of inertia.

    It follows the rotor as H = (2ζω_n s + ω_n²)/(s² + 2ζω_n s + ω_n²) and takes its torque from
    it: ω′ = ω (τ s + 1)/(τ s + 1 + m τ s H), m its share. A rotor at rest is held by the motor's
    friction, and does not swing with it.
    """

    form = "swinging load"
    meaning = "A load behind a soft coupling swings against the motor after every step."
    parameters = (
        Parameter(
            "load_share",
            "1",
            0.0,
            0.0,
            1.0,
            0.03,
            what="moment of inertia of the load over that of the motor",
        ),
        *_SHAPE,
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the rotor's speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        lag = _lag(context)
        seen = values["period_s"] >= _SHORTEST * context.window_s
        if not seen or values["load_share"] <= 0.0 or not lag.tau_s:
            return signal
        shape = (values["period_s"], values["damping"], context.window_s)
        swinging = _swinging(values["load_share"], lag, *shape)
        taken = lfilter(*swinging, signal - signal[0])
        moved: Array = np.where(_at_rest(signal, context), 0.0, taken)
        return signal - moved


def _at_rest(signal: Array, context: Context) -> Array:
    """Rows on which the rotor stands, and is to stand."""
    settled_rad_s = np.abs(context.settled_rad_s(context.phase_deg))
    fastest_rad_s = np.maximum(settled_rad_s, np.abs(signal))
    rest: Array = fastest_rad_s < _REST * np.max(settled_rad_s)
    return rest


FORMS = (ShaftCompliance(), DampedCoupling(), SwingingLoad())
