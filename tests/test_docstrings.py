"""Every public argument is documented: numpydoc's own parser says which are."""

import importlib
import inspect
import pkgutil
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from numpydoc.docscrape import FunctionDoc

import hil_sim
import usmbench

SELF = {"self", "cls"}


def modules() -> Iterator[str]:
    for package in (usmbench, hil_sim):
        yield package.__name__
        for found in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
            if not found.name.endswith("__main__"):
                yield found.name


def documented_in(documentation: str | None) -> set[str]:
    parsed = FunctionDoc(None, doc=inspect.cleandoc(documentation or ""))
    sections = (*parsed["Parameters"], *parsed["Other Parameters"])
    names = [name for parameter in sections for name in parameter.name.split(",")]
    return {name.strip().lstrip("*") for name in names}


def arguments_of(function: Callable[..., Any]) -> set[str]:
    return {n for n in inspect.signature(function).parameters if n not in SELF and n[0] != "_"}


def documented_of_method(kind: type, name: str) -> set[str]:
    """A method may leave to the one it overrides what that says already."""
    versions = (vars(base)[name] for base in kind.__mro__ if name in vars(base))
    return set().union(*(documented_in(version.__doc__) for version in versions))


def undocumented_of_class(kind: type) -> Iterator[str]:
    if "__init__" in vars(kind) and not issubclass(kind, tuple):
        for name in sorted(arguments_of(kind.__init__) - documented_in(kind.__doc__)):
            yield f"{kind.__qualname__}({name})"
    for name, member in vars(kind).items():
        function = inspect.unwrap(getattr(member, "__func__", member))
        if name.startswith("_") or not inspect.isfunction(function):
            continue
        for argument in sorted(arguments_of(function) - documented_of_method(kind, name)):
            yield f"{kind.__qualname__}.{name}({argument})"


def undocumented(module_name: str) -> Iterator[str]:
    module = importlib.import_module(module_name)
    for name, item in vars(module).items():
        if name.startswith("_") or getattr(item, "__module__", None) != module_name:
            continue
        if inspect.isclass(item):
            if not getattr(item, "_is_protocol", False):
                yield from undocumented_of_class(item)
        elif inspect.isfunction(item):
            for argument in sorted(arguments_of(item) - documented_in(item.__doc__)):
                yield f"{name}({argument})"


@pytest.mark.parametrize("module_name", sorted(modules()))
def test_every_public_argument_is_documented(module_name: str) -> None:
    assert list(undocumented(module_name)) == []


def test_an_undocumented_argument_is_found() -> None:
    def forgetful(phase_deg: float) -> None:
        """Set something."""

    class Forgetful:
        """Know nothing."""

        def __init__(self, speed_rad_s: float):
            self.speed_rad_s = speed_rad_s

    assert arguments_of(forgetful) - documented_in(forgetful.__doc__) == {"phase_deg"}
    assert next(iter(undocumented_of_class(Forgetful))).endswith("Forgetful(speed_rad_s)")
