"""What a user's own cause says of itself, held against what the diagnosis needs."""

import math
import re
from typing import Any, Final, get_args

from usmbench.model.effects.base import DynamicsEffect, Effect, Stage
from usmbench.model.effects.guarded import wrong
from usmbench.model.effects.lone_windows import SporadicEffect
from usmbench.model.effects.parameter import Parameter, Wave

_NAME: Final = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
_MISSING: Final = object()


def check_declared(effect: Effect) -> None:
    """Refuse a cause whose attributes are missing, or mean nothing.

    Parameters
    ----------
    effect
        The cause.

    Raises
    ------
    usmbench.errors.CauseError
        Some attribute is; the message names it.
    """
    problem = _wrong_words(effect) or _wrong_stage(effect) or _wrong_parameters(effect)
    if problem is not None:
        raise wrong(effect, problem)


def _wrong_words(effect: Effect) -> str | None:
    """Say which of the words about a cause will not do, or return None."""
    name = getattr(effect, "name", _MISSING)
    if not _is_name(name):
        shown = "it has no name" if name is _MISSING else f"its name is {name!r}"
        return f"{shown}: give it lower-case words with _ between them"
    for attribute in ("meaning", "mend"):
        if not _is_line(getattr(effect, attribute, _MISSING)):
            return f"it has no {attribute}, one line of text: add it"
    if effect.form and not _is_line(effect.form):
        return f"its form is {effect.form!r}: give it one line of text"
    return None


def _wrong_stage(effect: Effect) -> str | None:
    """Say why a cause would never act, or return None."""
    stages, stage = get_args(Stage), getattr(effect, "stage", _MISSING)
    if stage not in stages:
        shown = "it has no stage" if stage is _MISSING else f"its stage is {stage!r}"
        return f"{shown}: choose from {', '.join(stages)}"
    if stage == "dynamics" and not isinstance(effect, DynamicsEffect):
        return "its stage is dynamics, and it is no DynamicsEffect: derive it from that"
    if effect.sporadic and not isinstance(effect, SporadicEffect):
        return "it is sporadic, and no SporadicEffect: derive it from that"
    form_off: Any = effect.form_off
    if not _is_number(form_off) or form_off < 0.0:
        return f"its form_off is {form_off!r}: give PHYSICS or DEFINITION"
    return None


def _wrong_parameters(effect: Effect) -> str | None:
    """Say what is wrong with the parameters of a cause, or return None."""
    parameters: Any = getattr(effect, "parameters", None)
    if not isinstance(parameters, tuple) or not all(isinstance(p, Parameter) for p in parameters):
        return "it has no tuple of parameters: add it, () where it is there or not"
    names = [p.name for p in parameters]
    if len(set(names)) < len(names):
        return f"it has two parameters of one name among {', '.join(map(str, names))}: rename one"
    for wave in effect.waves:
        if not isinstance(wave, Wave) or not {wave.cosine, wave.sine} <= set(names):
            return "one of its waves names no two of its parameters: name its cosine and its sine"
    if effect.sporadic and "rate_hz" not in names:
        return "it is sporadic and has no parameter rate_hz, how often it strikes: add it"
    scanned = [p.name for p in parameters if p.scanned]
    if scanned and type(effect).grid is Effect.grid:
        return f"its parameter {scanned[0]} is scanned, and it has no grid: add the method"
    return next((problem for p in parameters if (problem := _wrong_parameter(p))), None)


def _wrong_parameter(p: Any) -> str | None:
    """Say what is wrong with a parameter, or return None."""
    if not _is_name(p.name):
        return f"its parameter {p.name!r} is named by no lower-case words with _ between them"
    if not all(_is_number(value) for value in (p.null, p.low, p.high, p.typical)):
        return f"null, low, high or typical of its parameter {p.name} is no number"
    if not p.low < p.high:
        return f"its parameter {p.name} has no range from {p.low:g} to {p.high:g}: low is below"
    if not p.low <= p.null <= p.high:
        return (
            f"null of its parameter {p.name} is {p.null:g}, outside {p.low:g} to {p.high:g}: "
            "widen the bounds, they hold what does nothing, too"
        )
    if not p.typical > 0.0:
        return f"typical of its parameter {p.name} is {p.typical:g}: give a size above 0"
    if not isinstance(p.unit, str) or not isinstance(p.what, str):
        return f"unit or what of its parameter {p.name} is no text"
    return None


def _is_name(value: object) -> bool:
    return isinstance(value, str) and _NAME.fullmatch(value) is not None


def _is_line(value: object) -> bool:
    return isinstance(value, str) and bool(value.strip()) and value.isprintable()


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and math.isfinite(value)
