"""A soft shaft between motor and disc."""

import math
from collections.abc import Sequence

import numpy as np
from scipy.signal import lfilter

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values

_SUBSTEPS = 8


class ShaftCompliance(Effect):
    """The disc follows the rotor as ω_n²/(s² + 2ζω_n s + ω_n²): it rings after every step.

    Integrated exactly over parts of a window through which the rotor's speed is held, then
    averaged over the window, as the counter does.
    """

    name = "shaft_compliance"
    meaning = "The shaft or its coupling twists: the disc rings after the rotor changes speed."
    mend = "Tighten or stiffen the coupling between motor and disc; look for a cracked helix."
    stage = "motion"
    parameters = (
        Parameter("period_s", "s", 0.0, 0.0, 0.5, 0.003, scanned=True),
        Parameter("damping", "1", 0.1, 0.01, 0.8, 0.05, scanned=True),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the disc's speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        if values["period_s"] <= 0.0:
            return signal
        step_s = context.window_s / _SUBSTEPS
        b, a = _held(2.0 * math.pi / values["period_s"], values["damping"], step_s)
        held = np.repeat(signal - signal[0], _SUBSTEPS)
        rung: Array = lfilter(b, a, held).reshape(-1, _SUBSTEPS).mean(axis=1) + signal[0]
        return rung

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return periods from a tenth of a window to some thirty.

        Parameters
        ----------
        contexts
            All stretches.
        """
        periods_s = contexts[0].window_s * np.geomspace(0.1, 30.0, 18)
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


FORMS = (ShaftCompliance(),)
