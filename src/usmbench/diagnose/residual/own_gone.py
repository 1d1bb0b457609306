"""A model's own effects that are gone, wholly or in part: mended, or less than they were."""

from collections.abc import Sequence
from typing import Any, ClassVar

from usmbench.model.applied import Applied
from usmbench.model.effects.base import DEFINITION, Array, Effect, Stage, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.parameter import Parameter

GONE = "gone"
"""Form of a cause that the model has and the motor has not."""
_ALL = 0.9  # of an effect: what is left is within what its form may be off by


class OwnGone(Effect):
    """A share of what one of the model's own effects does is not there.

    A subclass for each gives it the name of the cause.

    Parameters
    ----------
    own
        The effect.
    """

    form: ClassVar[str] = GONE
    stage: ClassVar[Stage] = "counter"
    form_off: ClassVar[float] = DEFINITION
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("share_gone", "1", 0.0, 0.0, 1.0, 0.1, what="of what the model's own cause does"),
    )

    def __init__(self, own: Applied):
        self.own = own

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the signal as it is: free runs are made without the effect.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return signal

    def entry_left(self, values: Values) -> dict[str, Any] | None:
        """Return what is left of the effect in a model file; None for nothing.

        Parameters
        ----------
        values
            What is gone. Of an effect whose parameters all shape it, most or nothing.
        """
        kept = 1.0 - values["share_gone"]
        sized = [p for p in self.own.effect.parameters if not p.scanned]
        if kept < 1.0 - _ALL or (not sized and kept < 0.5):
            return None
        less = {p.name: p.null + kept * (self.own.values[p.name] - p.null) for p in sized}
        return Applied(self.own.effect, {**self.own.values, **less}).to_mapping()


def gone_effects(own: Sequence[Applied]) -> list[Effect]:
    """Return causes that say of each of a model's effects that it is gone.

    Parameters
    ----------
    own
        The effects that a model was extended by.
    """
    return [_gone(applied) for applied in own]


def _gone(own: Applied) -> Effect:
    """Return the cause that says of one effect that it is gone."""
    cause = own.effect

    class Gone(OwnGone):
        name = cause.name
        meaning = "The model has this cause from earlier runs; the motor does not show it any more."
        mend = "If it was mended, go on with the extended model, which leaves it out."

    return Gone(own)


def first_gone(effects: Sequence[Applied]) -> tuple[float, list[Applied], list[Applied]] | None:
    """Return how much of an own effect is gone, and the other effects with it and without.

    Parameters
    ----------
    effects
        All effects, the model's own among them.

    Returns
    -------
    tuple of float and lists, or None
        The share, and the effects; None where none is gone.
    """
    for k, applied in enumerate(effects):
        if isinstance(applied.effect, OwnGone):
            rest = [*effects[:k], *effects[k + 1 :]]
            without = [other for other in rest if other is not applied.effect.own]
            return applied.values["share_gone"], rest, without
    return None
