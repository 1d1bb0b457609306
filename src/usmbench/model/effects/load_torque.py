"""A steady torque that the simulation does not know.

Where the curve leaves the dead zone in a sharp bend, a torque takes its speed until the rotor
stands. Where the bend is gradual, v = ½ (u + √(u² + r²)) of a straight line u, it moves along
the bend: the torque takes its speed from u.
"""

from collections.abc import Sequence

import numpy as np

from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context, highest_settled_rad_s
from usmbench.model.effects.later_start import standing_rad_s
from usmbench.model.effects.parameter import Parameter

_MEANING = "A steady torque acts on the shaft that the simulation does not know."
_MEND = "Look for a weight, a rubbing seal, a misaligned coupling or a brake that is not quite off."
_HELD = 2e-3  # of the highest speed; nothing measured sets it


def _braked(signal: Array, loss_rad_s: Array, context: Context) -> Array:
    """Take a loss from a speed; the torque cannot start a rotor that the contact holds.

    Where it is held, the speed stays as the curve has it: drawn through a dead zone, that is hardly
    ever 0 in all of it.
    """
    slower = signal - loss_rad_s
    reversed_way = signal * slower < 0.0
    held = np.abs(signal) <= standing_rad_s(context, _HELD)
    return np.where(held, signal, np.where(reversed_way, 0.0, slower))


_ROUNDED = Parameter(
    "rounded_rad_s",
    "rad/s",
    0.3,
    1e-3,
    5.0,
    0.3,
    scanned=True,
    what="speed over which the curve bends where it leaves the dead zone",
)
_SHARES = (0.01, 0.03, 0.06, 0.12, 0.25)  # of the highest speed
_STANDS = 1e-9


def _along_bend(signal: Array, loss_rad_s: Array, rounded_rad_s: float) -> Array:
    """Take a loss from the straight line that a gradual bend rounds off."""
    size = np.maximum(np.abs(signal), _STANDS)
    straight = size - rounded_rad_s**2 / (4.0 * size) - np.sign(signal) * loss_rad_s
    # As (u + √(u² + r²)) / 2, which cancels where u is far below 0.
    root = np.hypot(straight, rounded_rad_s)
    slower = np.where(
        straight > 0.0, 0.5 * (straight + root), 0.5 * rounded_rad_s**2 / (root - straight)
    )
    return np.where(np.abs(signal) < _STANDS, 0.0, np.sign(signal) * slower)


class Weight(Effect):
    """v′ = v − w while the rotor runs: a weight on a drum, on the straight speed–torque curve."""

    name = "load_torque"
    form = "weight"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"
    parameters = (
        Parameter(
            "one_sided_rad_s",
            "rad/s",
            0.0,
            -30.0,
            30.0,
            0.02,
            what="speed that a running rotor loses forwards and gains backwards",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return _braked(signal, np.full(signal.shape, values["one_sided_rad_s"]), context)


class CreepingWeight(Weight):
    """v′ = v − w, also where the wave stands: a weight that the contact does not hold there."""

    form = "weight, creeping"

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return signal - values["one_sided_rad_s"] * context.driven


class Drag(Effect):
    """v′ = v − d sign(v) while the rotor runs: dry friction outside the motor."""

    name = "load_torque"
    form = "drag"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"
    parameters = (
        Parameter(
            "drag_rad_s",
            "rad/s",
            0.0,
            -3.0,
            30.0,
            0.02,
            what="speed that a running rotor loses, either way",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return _braked(signal, values["drag_rad_s"] * np.sign(signal), context)


class WiderDeadZone(Effect):
    """v′ = v(φ − w sign φ), and v(0) within w: a drag that is least felt where the wave travels.

    The dead zone grows with the load (Mojallali and Ahmadi 2011, Section V), the highest speed
    stays.
    """

    name = "load_torque"
    form = "drag, wider dead zone"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"
    parameters = (
        Parameter(
            "wider_deg",
            "deg",
            0.0,
            -20.0,
            60.0,
            0.2,
            what="how much farther from 0°, either way, the rotor does what it did before",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        phase_deg = context.phase_deg
        nearer_deg = np.maximum(np.abs(phase_deg) - values["wider_deg"], 0.0)
        return signal + context.moved_rad_s(np.sign(phase_deg) * nearer_deg)


class _AlongBend(Effect):
    """A torque where the curve leaves the dead zone gradually."""

    name = "load_torque"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return bends up to a quarter of the highest speed.

        Parameters
        ----------
        contexts
            All stretches.
        """
        bends_rad_s = highest_settled_rad_s(contexts) * np.array(_SHARES)
        return {"rounded_rad_s": np.clip(bends_rad_s, _ROUNDED.low, _ROUNDED.high)}


class WeightAlongBend(_AlongBend):
    """v = r(u) becomes v′ = r(u − w), with r the bend: a weight where it is gradual."""

    form = "weight, gradual start"
    parameters = (*Weight.parameters, _ROUNDED)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        loss_rad_s = np.full(signal.shape, values["one_sided_rad_s"])
        return _along_bend(signal, loss_rad_s, values["rounded_rad_s"])


class DragAlongBend(_AlongBend):
    """v = r(u) becomes v′ = r(u − d sign(v)), with r the bend: a drag where it is gradual."""

    form = "drag, gradual start"
    parameters = (*Drag.parameters, _ROUNDED)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        loss_rad_s = values["drag_rad_s"] * np.sign(signal)
        return _along_bend(signal, loss_rad_s, values["rounded_rad_s"])


FORMS = (
    Weight(),
    CreepingWeight(),
    Drag(),
    WiderDeadZone(),
    WeightAlongBend(),
    DragAlongBend(),
)
