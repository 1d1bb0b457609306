"""Faults from the command line, from a file and from chance."""

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from hil_sim.faults import CAUSES, OPTIONS, Fault, FaultKind
from usmbench.errors import InputError
from usmbench.settings.yaml_source import read_source


def parse_fault(text: str) -> Fault:
    """Return the fault that a string such as "late_byte@1.5,direction=to_host" describes.

    Parameters
    ----------
    text
        kind@seconds, then options of `Fault` as ,name=value.

    Raises
    ------
    usmbench.errors.InputError
        The string does not describe a fault.
    """
    head, *options = text.split(",")
    kind, at, time_s = head.partition("@")
    entry: dict[str, Any] = {"kind": kind, "time_s": _value(time_s) if at else None}
    for option in options:
        name, equals, value = option.partition("=")
        if not equals:
            raise InputError(f"fault {text!r}: {option!r} is not name=value")
        entry[name] = _value(value)
    return _fault(entry, f"fault {text!r}")


def read_faults(path: Path) -> list[Fault]:
    """Return the faults of a YAML file: a list of mappings with the fields of `Fault`.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    usmbench.errors.InputError
        The file cannot be read or an entry does not describe a fault.
    """
    entries = read_source(path).document
    if not isinstance(entries, list):
        raise InputError("expected a list of faults, each with kind and time_s", file=path)
    try:
        return [_fault(entry, f"entry {n}") for n, entry in enumerate(entries, 1)]
    except InputError as error:
        raise InputError(str(error), file=path) from error


def random_fault(rng: np.random.Generator, latest_s: float) -> Fault:
    """Draw a fault of any kind at any instant.

    Parameters
    ----------
    rng
        Source of chance.
    latest_s
        Upper end of the instants drawn.
    """
    kind = FaultKind(rng.choice([str(kind) for kind in FaultKind]))
    draws: dict[str, Any] = {
        "direction": str(rng.choice(["to_board", "to_host"])),
        "bit": int(rng.integers(8)),
        "delay_s": float(rng.uniform(0.001, 0.2)),
        "cause": str(rng.choice(CAUSES)),
        "counts": int(rng.integers(1, 4000)),
        "channel": str(rng.choice(["a", "b"])),
    }
    instant_s = 0.0 if kind is FaultKind.COUNTER_WRAP else float(rng.uniform(0.0, latest_s))
    options = OPTIONS.get(kind, frozenset())
    return Fault(kind, instant_s, **{name: draws[name] for name in draws if name in options})


def _value(text: str) -> int | float | str:
    """Read a number as a number and leave anything else to the checks."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def _fault(entry: Any, where: str) -> Fault:
    """Check one entry of a schedule."""
    known = {field.name for field in fields(Fault)}
    if not isinstance(entry, dict) or not {"kind", "time_s"} <= set(entry) <= known:
        raise InputError(f"{where}: a fault has kind, time_s and options of its kind")
    if entry["kind"] not in list(FaultKind):
        raise InputError(f"{where}: no such kind; there are {', '.join(FaultKind)}")
    for name in ("time_s", "bit", "delay_s", "counts", "duration_s"):
        number = entry.get(name, 0)
        if isinstance(number, bool) or not isinstance(number, (int, float)):
            raise InputError(f"{where}: {name} must be a number")
        if name in ("bit", "counts") and not isinstance(number, int):
            raise InputError(f"{where}: {name} must be a whole number, not {number}")
    try:
        return Fault(**{**entry, "kind": FaultKind(entry["kind"])})
    except InputError as error:
        raise InputError(f"{where}: {error}") from error
