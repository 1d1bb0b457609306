"""What writing for other tools has in common: their packages and their names."""

import importlib
import re
from collections.abc import Iterable
from typing import Any, Final

from usmbench.errors import InputError

_LONGEST: Final = 63  # MATLAB's namelengthmax


def package(name: str) -> Any:
    """Return a package that the bench itself does not need.

    Parameters
    ----------
    name
        The package.

    Raises
    ------
    usmbench.errors.InputError
        It is not installed.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise InputError(
            f"{name} is not installed; install it with `pip install usmbench[interop]`"
        ) from error


def field_names(names: Iterable[str]) -> dict[str, str]:
    """Return for each name one that MATLAB and NetCDF take: letters, digits and _, each once.

    Parameters
    ----------
    names
        Names of columns, the user's own among them; those that will do stay as they are.
    """
    found: dict[str, str] = {}
    for name in sorted(names, key=lambda name: not _is_field(name)):
        field = re.sub(r"[^A-Za-z0-9_]", "_", name)
        field = (field if _is_field(field[:1]) else f"x{field}")[:_LONGEST]
        number = 1
        while field in found.values():
            number += 1
            field = f"{field[: _LONGEST - len(str(number)) - 1]}_{number}"
        found[name] = field
    return found


def _is_field(name: str) -> bool:
    return re.fullmatch(rf"[A-Za-z][A-Za-z0-9_]{{0,{_LONGEST - 1}}}", name) is not None
