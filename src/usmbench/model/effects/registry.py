"""The library of effects: whatever is registered under the entry point group."""

from collections.abc import Sequence
from functools import cache
from importlib.metadata import entry_points

from usmbench.errors import InputError
from usmbench.model.effects.base import Effect

GROUP = "usmbench.effects"


@cache
def library() -> tuple[Effect, ...]:
    """Return every form of every cause, in the order of their names.

    Raises
    ------
    InputError
        An entry point of the group cannot be loaded, or is no tuple of effects.
    """
    forms: list[Effect] = []
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name):
        try:
            found = entry.load()
        except Exception as error:  # a user's own file may fail in any way
            raise InputError(
                f"the cause {entry.name} ({entry.value}) cannot be loaded: "
                f"{type(error).__name__}: {error}; mend or remove the package that registers it"
            ) from error
        members = tuple(found) if isinstance(found, Sequence) else (found,)
        if not members or not all(isinstance(member, Effect) for member in members):
            raise InputError(
                f"the cause {entry.name} ({entry.value}) is no tuple of effects; "
                "see docs/how-to/add-a-cause.md"
            )
        forms.extend(members)
    return tuple(forms)


def find_effect(name: str, form: str) -> Effect:
    """Return one form of a cause.

    Parameters
    ----------
    name, form
        As stored in a model file.

    Raises
    ------
    InputError
        No such cause is registered.
    """
    for effect in library():
        if (effect.name, effect.form) == (name, form):
            return effect
    known = ", ".join(dict.fromkeys(effect.name for effect in library()))
    raise InputError(
        f"the cause {name!r} ({form or 'only form'}) is not installed; known are {known}"
    )
