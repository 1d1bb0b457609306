"""The library of effects: whatever is registered under the entry point group."""

from collections.abc import Sequence
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from usmbench.errors import CauseError, InputError
from usmbench.model.effects.base import Effect
from usmbench.model.effects.declared import check_declared
from usmbench.model.effects.guarded import one_line
from usmbench.model.effects.trial import try_out

GROUP = "usmbench.effects"


@cache
def library() -> tuple[Effect, ...]:
    """Return every form of every cause, in the order of their names.

    Raises
    ------
    CauseError
        A package of the user's own registers what cannot be loaded, is no tuple of effects, fails
        on a made-up run, or has the name of another cause.
    """
    # Those that ship come first: a name is theirs, whatever else is installed.
    entries = sorted(entry_points(group=GROUP), key=lambda entry: (not _ships(entry), entry.name))
    forms: dict[EntryPoint, tuple[Effect, ...]] = {}
    owners: dict[str, EntryPoint] = {}
    for entry in entries:
        forms[entry] = _loaded(entry)
        if not _ships(entry):
            _check(entry, forms[entry], owners)
        owners |= {effect.name: entry for effect in forms[entry]}
    by_name = sorted(forms, key=lambda entry: entry.name)
    return tuple(effect for entry in by_name for effect in forms[entry])


def _ships(entry: EntryPoint) -> bool:
    """Whether a cause is one of our own, which the tests hold to all that is checked here."""
    return entry.value.startswith("usmbench.")


def _loaded(entry: EntryPoint) -> tuple[Effect, ...]:
    """Return the effects that an entry point names."""
    where = f"the cause {entry.name} ({entry.value})"
    try:
        found: Any = entry.load()
        members = tuple(found) if isinstance(found, Sequence) else (found,)
    except (Exception, SystemExit) as error:  # a user's own file may fail in any way
        raise CauseError(
            f"{where} cannot be loaded: {one_line(error)}; mend or remove the package that "
            "registers it"
        ) from error
    if members and all(isinstance(member, Effect) for member in members):
        return members
    kinds = [member.__name__ for member in members if isinstance(member, type)]
    mend = f": write {kinds[0]}() for {kinds[0]}" if kinds else ""
    raise CauseError(f"{where} is no tuple of effects{mend}; see docs/how-to/add-a-cause.md")


def _check(entry: EntryPoint, forms: Sequence[Effect], owners: dict[str, EntryPoint]) -> None:
    """Refuse a user's effects that will not do, or have the name of others."""
    seen: set[tuple[str, str]] = set()
    for effect in forms:
        try:
            check_declared(effect)
            try_out(effect)
        except CauseError as error:
            raise CauseError(f"entry point {entry.name}: {error}") from error
        where = f"the cause {entry.name} ({entry.value})"
        if effect.name in owners:
            raise CauseError(
                f"{where} is named {effect.name}, as is that of {owners[effect.name].value}; give "
                "it a name of its own"
            )
        if (effect.name, effect.form) in seen:
            form = f"the form {effect.form!r}" if effect.form else "the same form"
            raise CauseError(
                f"{where} has {form} of {effect.name} twice; give each a form of its own"
            )
        seen.add((effect.name, effect.form))


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
    CauseError
        As `library`.
    """
    for effect in library():
        if (effect.name, effect.form) == (name, form):
            return effect
    known = ", ".join(dict.fromkeys(effect.name for effect in library()))
    raise InputError(
        f"the cause {name!r} ({form or 'only form'}) is not installed; known are {known}"
    )
