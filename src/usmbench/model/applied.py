"""Effects with values for their parameters, and as a model file lists them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from usmbench.errors import InputError
from usmbench.model.effects.base import Effect, Values
from usmbench.model.effects.parameter import Parameter
from usmbench.model.effects.registry import find_effect


@dataclass(frozen=True, slots=True)
class Applied:
    """An effect with a value for each of its parameters.

    Parameters
    ----------
    effect
        The effect.
    values
        Its parameters.
    """

    effect: Effect
    values: Values

    def to_mapping(self) -> dict[str, Any]:
        """Return the entry of a model file's `effects`."""
        return {
            "name": self.effect.name,
            "form": self.effect.form,
            "stage": self.effect.stage,
            "parameters": {name: float(value) for name, value in self.values.items()},
        }


def applied_effects(entries: Sequence[Mapping[str, Any]]) -> tuple[Applied, ...]:
    """Return the effects that a model file lists.

    Parameters
    ----------
    entries
        The file's `effects`.

    Raises
    ------
    usmbench.errors.InputError
        A cause that is not installed, or a parameter is missing or beyond its bounds.
    """
    found = []
    for entry in entries:
        effect = find_effect(str(entry["name"]), str(entry.get("form", "")))
        given = entry.get("parameters") or {}
        found.append(Applied(effect, {p.name: _given(effect, p, given) for p in effect.parameters}))
    return tuple(found)


def _given(effect: Effect, p: Parameter, given: Mapping[str, Any]) -> float:
    """Value of a parameter among those given, within its bounds."""
    if p.name not in given:
        raise InputError(
            f"the model's effect {effect.name} lacks {p.name}; give it among its parameters"
        )
    value = float(given[p.name])
    if not p.low <= value <= p.high:
        unit = "" if p.unit == "1" else f" {p.unit}"
        raise InputError(
            f"the model's effect {effect.name} has {p.name} = {value:g}; it may be {p.low:g} to "
            f"{p.high:g}{unit}"
        )
    return value


def foreseen_effects(entries: Sequence[Mapping[str, Any]]) -> tuple[Applied, ...]:
    """Return the effects that a free run can follow: of single windows nobody foresees which.

    Parameters
    ----------
    entries
        A model file's `effects`.

    Raises
    ------
    usmbench.errors.InputError
        As `applied_effects`.
    """
    return tuple(a for a in applied_effects(entries) if not a.effect.sporadic)
