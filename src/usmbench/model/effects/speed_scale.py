"""All speeds are off by one factor."""

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

from usmbench.model.effects.base import (
    DEFINITION,
    PHYSICS,
    Array,
    DynamicsEffect,
    Effect,
    Stage,
    Values,
)
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import lag_of
from usmbench.model.effects.parameter import Parameter
from usmbench.model.hammerstein import LinearPart


class SpeedScale(Effect):
    """ω′ = ω (1 + s): another number of counts a revolution, motor gain, or unit of speed."""

    name = "speed_scale"
    meaning = "All speeds differ from the simulation by one factor."
    mend = (
        "Check counts_per_rev against the disc, the sample clock, the unit (9.55 rpm are 1 rad/s), "
        "and the drive amplitude."
    )
    stage: ClassVar[Stage] = "counter"
    form_off: ClassVar[float] = DEFINITION
    parameters = (
        Parameter(
            "scale_error",
            "1",
            0.0,
            -0.9,
            100.0,
            0.01,
            what="measured speed over simulated speed, less 1",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return signal * (1.0 + values["scale_error"])


class MotorGain(SpeedScale):
    """v′ = v (1 + s): the motor's gain alone, whose jumps a torque limit does not let grow."""

    form = "of the motor"
    stage = "settled"
    form_off = PHYSICS

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why these runs cannot show the cause, or None where they can.

        Parameters
        ----------
        contexts
            All stretches.
        """
        if any(c.linear.slip_limit_rad_s is not None for c in contexts):
            return None
        return "without a torque limit the motor's gain is that of the counter"


class MovedContact(SpeedScale, DynamicsEffect):
    """v′ = v (1 + s), τ′ = τ (1 + s)²: the rotor touches the stator at a radius 1/(1 + s) as large.

    There the same slip of the surfaces is 1 + s times as much of the rotor's speed, and the same
    force 1 + s times less torque.
    """

    form = "of the contact"
    meaning = "The rotor touches the stator at another radius: speeds and lag differ."
    mend = "Look at the friction layer's track on the stator; lap it, or let it bed in again."
    stage = "settled"
    form_off = PHYSICS

    def linear_part(self, linear: LinearPart, context: Context, values: Values) -> LinearPart:
        """Return the linear part of the other lag.

        Parameters
        ----------
        linear, context, values
            As in `DynamicsEffect.linear_part`.
        """
        known, ratio = lag_of(linear, context.window_s), 1.0 + values["scale_error"]
        if known is None or ratio == 1.0:
            return linear
        other = replace(known, tau_s=known.tau_s * ratio**2).linear_part(context.window_s)
        slip = linear.slip_limit_rad_s
        return replace(other, slip_limit_rad_s=None if slip is None else slip * ratio)

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why these runs cannot show the cause, or None where they can.

        Parameters
        ----------
        contexts
            All stretches.
        """
        if all(lag_of(c.linear, c.window_s) is not None for c in contexts):
            return None
        return "the model's dynamics are no lag behind a delay"


FORMS = (SpeedScale(), MotorGain(), MovedContact())
