"""A soft shaft or coupling: between motor and disc, or between both and a load that swings."""

import math
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from scipy.signal import cont2discrete, lfilter

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values
from usmbench.model.linear import time_constant_s

_SUBSTEPS = 8
_REST = 0.01  # of the highest speed
_SHORTEST = 2.0  # windows a period: what swings faster looks like any ripple
_MEND = "Tighten or stiffen the coupling between motor and disc; look for a cracked helix."
_SHAPE = (
    Parameter("period_s", "s", 0.0, 0.0, 0.5, 0.003, scanned=True),
    Parameter("damping", "1", 0.1, 0.01, 0.8, 0.05, scanned=True),
)


class ShaftCompliance(Effect):
    """The disc follows the rotor as ω_n²/(s² + 2ζω_n s + ω_n²): it rings after every step.

    Integrated exactly over parts of a window through which the rotor's speed is held, then
    averaged over the window, as the counter does.
    """

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
        step_s = context.window_s / _SUBSTEPS
        b, a = _held(2.0 * math.pi / values["period_s"], values["damping"], step_s)
        return np.asarray(signal[0] + _averaged(b, a, signal - signal[0]))

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


def _held(natural_rad_s: float, damping: float, step_s: float) -> tuple[Array, Array]:
    """Difference equation of the second-order lag for an input held through each step."""
    fall = math.exp(-damping * natural_rad_s * step_s)
    ratio = damping / math.sqrt(1.0 - damping**2)
    turn = natural_rad_s * math.sqrt(1.0 - damping**2) * step_s
    cosine, sine = math.cos(turn), math.sin(turn)
    b1 = 1.0 - fall * (cosine + ratio * sine)
    b2 = fall * fall + fall * (ratio * sine - cosine)
    return np.array([0.0, b1, b2]), np.array([1.0, -2.0 * fall * cosine, fall * fall])


def _averaged(b: Array, a: Array, signal: Array) -> Array:
    """Filter a signal held through parts of a window, and average over the window."""
    held = np.append(np.repeat(signal, _SUBSTEPS), signal[-1])
    at_ends = lfilter(b, a, held)
    middle = 0.5 * (at_ends[:-1] + at_ends[1:])
    mean: Array = middle.reshape(-1, _SUBSTEPS).mean(axis=1)
    return mean


class SwingingLoad(ShaftCompliance):
    """Behind a soft coupling hangs a load of `load_share` of the motor's moment of inertia.

    It follows the rotor as H = (2ζω_n s + ω_n²)/(s² + 2ζω_n s + ω_n²) and takes its torque from
    it: ω′ = ω (τ s + 1)/(τ s + 1 + m τ s H), m its share. A rotor at rest is held by the motor's
    friction, and does not swing with it.
    """

    form = "swinging load"
    meaning = "A load behind a soft coupling swings against the motor after every step."
    parameters = (Parameter("load_share", "1", 0.0, 0.0, 1.0, 0.03), *_SHAPE)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the rotor's speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        tau_s = time_constant_s(context.linear)
        seen = values["period_s"] >= _SHORTEST * context.window_s
        if not seen or values["load_share"] <= 0.0 or not tau_s:
            return signal
        natural, damping = 2.0 * math.pi / values["period_s"], values["damping"]
        swing = np.array([1.0, 2.0 * damping * natural, natural**2])
        pull = values["load_share"] * tau_s * np.array([2.0 * damping * natural, natural**2, 0.0])
        both = np.polyadd(np.convolve(swing, [tau_s, 1.0]), pull)
        b, a, _ = cont2discrete((pull, both), context.window_s / _SUBSTEPS)
        taken = _averaged(np.ravel(b), a, signal - signal[0])
        moved: Array = np.where(_at_rest(signal, context), 0.0, taken)
        return signal - moved


def _at_rest(signal: Array, context: Context) -> Array:
    """Rows on which the rotor stands, and is to stand."""
    settled_rad_s = np.abs(context.settled_rad_s(context.phase_deg))
    fastest_rad_s = np.maximum(settled_rad_s, np.abs(signal))
    rest: Array = fastest_rad_s < _REST * np.max(settled_rad_s)
    return rest


FORMS = (ShaftCompliance(), SwingingLoad())
