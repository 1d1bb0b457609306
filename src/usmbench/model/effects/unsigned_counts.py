"""The sign of the speed is lost."""

import math
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from scipy.special import erf

from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context, highest_settled_rad_s
from usmbench.model.effects.parameter import Parameter
from usmbench.model.lagged import lagged

# Shares of the highest speed: what is less may be noise, or a model's ringing.
_MEASURED_BACKWARDS, _SIMULATED_BACKWARDS = 0.1, 0.3
_BOTH_WAYS = 0.2  # of the farthest command
_NO_NOISE_RAD_S = 1e-12


class UnsignedCounts(Effect):
    """ω′ = |ω|: without the second channel the counter counts every edge upward."""

    name = "unsigned_counts"
    meaning = "The sign of the speed is lost: one channel of the encoder is dead."
    mend = "Check both encoder channels with an oscilloscope, and the counter's decoding mode."
    stage = "counter"
    parameters: ClassVar[tuple[Parameter, ...]] = ()

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return np.abs(signal)

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why where the motor should never turn backwards.

        Parameters
        ----------
        contexts
            All stretches.
        """
        lowest = min(float(np.min(c.settled_rad_s(c.phase_deg))) for c in contexts)
        return None if lowest < 0.0 else "no command turns the motor backwards"

    def beneath(
        self,
        contexts: Sequence[Context],
        measured_rad_s: Sequence[Array],
        simulated_rad_s: Sequence[Array],
    ) -> bool:
        """Return whether the commands go both ways, and neither run nor model ever does.

        Parameters
        ----------
        contexts, measured_rad_s, simulated_rad_s
            As in `Effect.beneath`.
        """
        phase_deg = np.concatenate([c.phase_deg for c in contexts])
        both_ways = min(-phase_deg.min(), phase_deg.max()) > _BOTH_WAYS * np.abs(phase_deg).max()
        measured, simulated = (np.concatenate(list(s)) for s in (measured_rad_s, simulated_rad_s))
        return bool(
            both_ways
            and measured.min() > -_MEASURED_BACKWARDS * measured.max()
            and simulated.min() > -_SIMULATED_BACKWARDS * simulated.max()
        )


class WithItsNoise(UnsignedCounts):
    """ω′ = E|ω + e|, the noise e being normal: at rest the mean is then not 0.

    Source: the mean of the folded normal distribution, doi:10.1080/00401706.1961.10489974.
    """

    form = "with its noise"
    meaning = "The sign of the speed is lost, and that of its noise, so that a rotor at rest turns."
    parameters = (
        Parameter(
            "noise_rad_s",
            "rad/s",
            0.0,
            0.0,
            1e3,
            0.02,
            scanned=True,
            what="standard deviation of the noise that loses its sign, too",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported, on average.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        noise_rad_s = max(values["noise_rad_s"], _NO_NOISE_RAD_S)
        part = signal / (math.sqrt(2.0) * noise_rad_s)
        at_rest = noise_rad_s * math.sqrt(2.0 / math.pi) * np.exp(-(part**2))
        return np.asarray(at_rest + signal * erf(part))

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return noises of a thousandth to a tenth of the highest speed.

        Parameters
        ----------
        contexts
            All stretches.
        """
        shares = np.array([1e-3, 3e-3, 0.01, 0.03, 0.1])
        return {"noise_rad_s": highest_settled_rad_s(contexts) * shares}


class Rectified(UnsignedCounts):
    """ω′ = √(ω² + k²) − k, smoothed by a first-order lag: a tachometer behind a rectifier.

    Its diodes pass little below their knee k, and a capacitor smooths what they pass.
    """

    form = "rectified"
    meaning = "The sign of the speed is lost, and small speeds with it, as behind a rectifier."
    mend = "Take a tachometer's voltage before its rectifier; of an encoder, check both channels."
    parameters = (
        Parameter(
            "knee_rad_s",
            "rad/s",
            0.0,
            0.0,
            1e3,
            0.5,
            scanned=True,
            what="speed below which the rectifier passes little",
        ),
        Parameter(
            "smoothing_s",
            "s",
            0.0,
            0.0,
            1.0,
            0.01,
            scanned=True,
            what="time constant of the smoothing",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        knee_rad_s, smoothing_s = values["knee_rad_s"], values["smoothing_s"]
        passed = signal**2 / np.maximum(np.hypot(signal, knee_rad_s) + knee_rad_s, 1e-300)
        if smoothing_s <= 0.0:
            return np.asarray(passed)
        return lagged(passed, math.exp(-context.window_s / smoothing_s), passed[0])

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return knees up to some times the highest speed, and up to four windows of smoothing.

        Parameters
        ----------
        contexts
            All stretches.
        """
        return {
            "knee_rad_s": highest_settled_rad_s(contexts) * np.array([0.0, 0.1, 0.3, 1.0, 3.0]),
            "smoothing_s": contexts[0].window_s * np.array([0.0, 1.0, 2.0, 4.0]),
        }


FORMS = (UnsignedCounts(), WithItsNoise(), Rectified())
