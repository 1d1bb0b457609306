"""Once-per-revolution ripple."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context, middle_rad
from usmbench.model.effects.parameter import Parameter, Wave

_TURNS = 0.1  # an arc in which a ripple bends by a twentieth of itself
# Of the ripple once a revolution: what ripples more twice is another fault. Nothing measured sets
# where that begins.
_SMALLER, _OF_ONCE = (-0.4, 0.4), "share of that ripple that goes"
_ROUNDS = 5  # of Newton's, after which a ripple of a half leaves 1e-14 rad


class EncoderEccentricity(Effect):
    """ω′ = ω (1 + c cos α + s sin α): the disc's centre is off the axis of rotation.

    With the disc off by e and read at radius R, the marks pass with ω (1 + (e/R) cos(α − α₀)).
    """

    name = "encoder_eccentricity"
    meaning = "The encoder's disc is off centre: a ripple once a revolution, relative to the speed."
    mend = "Centre the disc, or calibrate it by an average over whole revolutions."
    stage = "counter"
    early = True  # a counter counts what passes it
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "cosine",
            "1",
            0.0,
            -0.5,
            0.5,
            0.005,
            what="ripple over speed that goes as cos α, α the angle that the run reports",
        ),
        Parameter("sine", "1", 0.0, -0.5, 0.5, 0.005, what="the same with sin α"),
    )
    waves: ClassVar[tuple[Wave, ...]] = (
        Wave("ripple", "cosine", "sine", "how far the disc is off, of the radius it is read at"),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        angle_rad = context.angle_rad
        if angle_rad is None:
            angle_rad = middle_rad(signal, context.window_s)
        else:
            angle_rad = self.of_shaft_rad(angle_rad, values)
        return signal * (1.0 + self.ripple(angle_rad, values))

    def ripple(self, angle_rad: Array, values: Values) -> Array:
        """Return the ripple over the speed, shape (N,).

        Parameters
        ----------
        angle_rad
            The shaft's angle in the middle of the windows, shape (N,).
        values
            The parameters.
        """
        return _wave(angle_rad, values["cosine"], values["sine"])

    def of_shaft_rad(self, angle_rad: Array, values: Values) -> Array:
        """Return the shaft's angle where a run reports one, shape (N,).

        Parameters
        ----------
        angle_rad
            The angle that is reported, in the middle of the windows, shape (N,).
        values
            The parameters.
        """
        return angle_rad

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why where the shaft never turns far enough.

        Parameters
        ----------
        contexts
            All stretches.
        """
        known = [c.angle_rad for c in contexts if c.angle_rad is not None]
        turns = max((float(np.ptp(a)) / (2.0 * np.pi) for a in known), default=_TURNS)
        if turns >= _TURNS:
            return None
        return f"the shaft turns {turns:.2f} times; a ripple once a revolution needs {_TURNS:g}"


class ByItsOwnCounts(EncoderEccentricity):
    """The same, where the angle is counted by that disc: α′ = α + c sin α − s cos α.

    Of a ripple of a tenth the difference is a ripple of half a hundredth, twice a revolution.
    """

    form = "by its own counts"

    def of_shaft_rad(self, angle_rad: Array, values: Values) -> Array:
        """Return the shaft's angle from that which the disc has counted, shape (N,).

        Parameters
        ----------
        angle_rad, values
            As in `EncoderEccentricity.of_shaft_rad`.
        """
        cosine, sine = values["cosine"], values["sine"]
        shaft_rad = angle_rad
        for _ in range(_ROUNDS):
            along, across = np.cos(shaft_rad), np.sin(shaft_rad)
            ahead_rad = cosine * across - sine * along
            growth = 1.0 + cosine * along + sine * across
            shaft_rad = shaft_rad + (angle_rad - ahead_rad - shaft_rad) / growth
        return shaft_rad


class EccentricAndTilted(ByItsOwnCounts):
    """The same, and a smaller ripple twice a revolution: a disc that is not flat besides."""

    form = "and tilted"
    parameters = (
        *EncoderEccentricity.parameters,
        Parameter("twice_cosine", "1", 0.0, *_SMALLER, 0.05, what=f"{_OF_ONCE} as cos 2α"),
        Parameter("twice_sine", "1", 0.0, *_SMALLER, 0.05, what="the same with sin 2α"),
    )
    waves = (
        *EncoderEccentricity.waves,
        Wave("twice", "twice_cosine", "twice_sine", "ripple twice a revolution, over that once"),
    )

    def ripple(self, angle_rad: Array, values: Values) -> Array:
        """Return the ripple over the speed, shape (N,).

        Parameters
        ----------
        angle_rad, values
            As in `EncoderEccentricity.ripple`.
        """
        once = np.hypot(values["cosine"], values["sine"])
        tilt: Array = once * _wave(2.0 * angle_rad, values["twice_cosine"], values["twice_sine"])
        return super().ripple(angle_rad, values) + tilt


def _wave(angle_rad: Array, cosine: float, sine: float) -> Array:
    return np.asarray(cosine * np.cos(angle_rad) + sine * np.sin(angle_rad))


FORMS = (EncoderEccentricity(), ByItsOwnCounts(), EccentricAndTilted())
