"""A document held against its JSON Schema; the first thing wrong becomes one line."""

import difflib
import json
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import cache
from importlib import resources
from typing import Any

from jsonschema import Draft202012Validator, FormatChecker
from jsonschema.exceptions import ValidationError
from jsonschema.protocols import Validator
from jsonschema.validators import extend

from usmbench.settings.yaml_source import PathInDocument, Source

_FORMATS = FormatChecker(formats=())


@cache
def _validator(name: str) -> Validator:
    text = (
        resources.files(__package__).joinpath("schemas", f"{name}.schema.json").read_text("utf-8")
    )
    # JSON has no NaN and no infinity, but YAML has; no limit would refuse a NaN.
    types = Draft202012Validator.TYPE_CHECKER.redefine("number", lambda _, v: _is_number(v))
    kind: Any = extend(Draft202012Validator, type_checker=types)  # type: ignore[no-untyped-call]
    validator: Validator = kind(json.loads(text), format_checker=_FORMATS)
    return validator


def _is_number(value: object) -> bool:
    if isinstance(value, float):
        return math.isfinite(value)
    return isinstance(value, int) and not isinstance(value, bool)


@_FORMATS.checks("date-time", raises=ValueError)
def _is_moment(value: object) -> bool:
    """Raise where text is no time; without a zone it is local time."""
    return not isinstance(value, str) or datetime.fromisoformat(value) is not None


@dataclass(frozen=True, slots=True)
class _Fault:
    """One thing wrong: the schema's keyword, what it wants, what is there instead, and where."""

    keyword: str
    wanted: Any
    value: Any
    schema: dict[str, Any]
    path: PathInDocument


def check(source: Source, name: str) -> None:
    """Hold a document against the schema that ships under a name.

    Parameters
    ----------
    source
        The document.
    name
        The schema: "plan", "bench", "import", "model", "diagnosis" or "run".

    Raises
    ------
    usmbench.errors.InputError
        The document is wrong: names the first line that is, and the mend.
    """
    faults = [_fault(_innermost(e)) for e in _validator(name).iter_errors(source.document)]
    if faults:
        # The format is named first: every other error of an alien file is a consequence. A key that
        # is missing may be the one that was misspelt, so the unknown key goes before.
        first = min(faults, key=lambda fault: _rank(source, fault))
        raise source.error(first.path, _MESSAGES.get(first.keyword, _other)(first))


def _rank(source: Source, fault: _Fault) -> tuple[bool, int, bool]:
    line = source.lines.get(fault.path, 0)
    return fault.path != ("format",), line, fault.keyword == "required"


def _fault(error: ValidationError) -> _Fault:
    schema: Any = error.schema
    instance: Any = error.instance
    path: PathInDocument = tuple(error.absolute_path)
    if error.validator == "additionalProperties":
        path = (*path, next(str(k) for k in instance if k not in schema["properties"]))
    return _Fault(str(error.validator), error.validator_value, instance, schema, path)


def _innermost(error: ValidationError) -> ValidationError:
    """Return what is wrong inside the one alternative whose type fits, else the whole."""
    while error.validator == "anyOf" and error.context:
        depth = len(error.absolute_path)
        alternatives: dict[Any, list[ValidationError]] = {}
        for inner in error.context:
            alternatives.setdefault(inner.relative_schema_path[0], []).append(inner)
        fitting = [
            found
            for found in alternatives.values()
            if not any(e.validator == "type" and len(e.absolute_path) == depth for e in found)
        ]
        if len(fitting) != 1:
            break
        error = fitting[0][0]
    return error


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _listed(values: Iterable[Any]) -> str:
    return ", ".join(str(value) for value in values)


def _choices(values: Iterable[Any]) -> str:
    """List values, in quotes where they would be misread, such as a comma or a tab."""
    return _listed(v if str(v).isidentifier() else repr(v) for v in values)


def did_you_mean(word: str, known: Sequence[str]) -> str:
    """Return a hint at the known word nearest to an unknown one, or at all of them.

    Parameters
    ----------
    word
        What was written.
    known
        What may be written.
    """
    near = difflib.get_close_matches(word, known, n=1, cutoff=0.6)
    return f"did you mean {near[0]}?" if near else f"choose from: {_listed(sorted(known))}"


def _unknown_key(fault: _Fault) -> str:
    return f"unknown key; {did_you_mean(str(fault.path[-1]), list(fault.schema['properties']))}"


def _missing_key(fault: _Fault) -> str:
    missing = next(key for key in fault.wanted if key not in fault.value)
    about = fault.schema["properties"][missing]
    if "const" in about:
        return f"has no key {missing}; add {missing}: {about['const']}"
    return f"has no key {missing}; add it{_described(about)}"


def _described(schema: dict[str, Any]) -> str:
    return f" ({schema['description']})" if "description" in schema else ""


_TYPES = {
    "number": "a number",
    "integer": "a whole number",
    "string": "text",
    "object": "a mapping of keys",
    "array": "a list",
    "null": "null",
}


def _wrong_type(fault: _Fault) -> str:
    wanted = [fault.wanted] if isinstance(fault.wanted, str) else fault.wanted
    names = " or ".join(_TYPES[name] for name in wanted)
    return f"{_shown(fault.value)} is not {names}{_number_hint(fault.value)}"


def _number_hint(value: Any) -> str:
    """Return how YAML 1.1 wants a number such as 41e3, which it reads as text."""
    try:
        number = float(value) if isinstance(value, str) else None
    except ValueError:
        number = None
    if number is None:
        return ""
    digits, e, exponent = repr(number).partition("e")
    point = ".0" if e and "." not in digits else ""
    return f"; to YAML that is text: write {digits}{point}{e}{exponent}"


def _misfit(fault: _Fault) -> str:
    hint = _number_hint(fault.value) or _described(fault.schema)
    return f"{_shown(fault.value)} does not fit{hint}"


def _limit(is_wrong: str, choose: str) -> Callable[[_Fault], str]:
    return lambda fault: (
        f"{_shown(fault.value)} {is_wrong} {fault.wanted}; choose {choose} {fault.wanted}"
    )


def _length(unit: str, choose: str) -> Callable[[_Fault], str]:
    return lambda fault: f"has {len(fault.value)} {unit}; give {choose} {fault.wanted}"


def _other(fault: _Fault) -> str:
    return f"{_shown(fault.value)} is not what {fault.keyword} {fault.wanted} allows"


_MESSAGES: dict[str, Callable[[_Fault], str]] = {
    "additionalProperties": _unknown_key,
    "required": _missing_key,
    "type": _wrong_type,
    "anyOf": _misfit,
    "pattern": _misfit,
    "format": _misfit,
    "minimum": _limit("is below", "at least"),
    "maximum": _limit("is above", "at most"),
    "exclusiveMinimum": _limit("is not above", "more than"),
    "enum": lambda f: f"{_shown(f.value)} is not known; choose from: {_choices(f.wanted)}",
    "const": lambda f: f"{_shown(f.value)} is not supported; write {f.wanted}",
    "minItems": _length("entries", "at least"),
    "maxItems": _length("entries", "at most"),
    "minLength": _length("characters", "at least"),
    "maxLength": _length("characters", "at most"),
}
