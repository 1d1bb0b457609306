"""A user's own cause, asked so that whatever it does wrong is told in one line, with its name."""

from collections.abc import Callable, Mapping
from functools import wraps
from inspect import getattr_static
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import CauseError, InputError
from usmbench.model.hammerstein import LinearPart

_OWN: Final = "usmbench."
_LONGEST: Final = 200


def wrong(effect: Any, problem: str, line: int | None = None) -> CauseError:
    """Return the error that names a user's cause.

    Parameters
    ----------
    effect
        The cause, whatever it may lack.
    problem
        What is wrong with it.
    line
        Line of its file, counted from 1, where that is known.
    """
    kind = effect if isinstance(effect, type) else type(effect)
    name = getattr_static(effect, "name", None)
    shown = name if isinstance(name, str) and name.isidentifier() else kind.__qualname__
    where = kind.__module__ if line is None else f"{kind.__module__}, line {line}"
    return CauseError(
        f"the cause {shown} ({where}): {problem}; mend it or remove the package that registers it, "
        "see docs/how-to/add-a-cause.md"
    )


def one_line(error: BaseException) -> str:
    """Return an exception as one short line.

    Parameters
    ----------
    error
        The exception.
    """
    return f"{type(error).__name__}: {' '.join(str(error).split())}"[:_LONGEST].rstrip(": ")


def guard(kind: type) -> None:
    """Let a class tell in one line what its methods raise, or return that is of no use.

    Those of usmbench are left alone: a fault there is ours, and its traceback is wanted.

    Parameters
    ----------
    kind
        A class of effects.
    """
    for name, checked in _ASKED.items():
        method = getattr_static(kind, name, None)
        module = getattr(method, "__module__", None) or _OWN
        if not module.startswith(_OWN):
            setattr(kind, name, _guarded(name, method, checked))


def _guarded(name: str, method: Any, checked: Callable[[Any, Any, Any], Any]) -> Any:
    """Return a method that asks another, and holds its answer against what was wanted."""

    @wraps(method)
    def asked(self: Any, *given: Any) -> Any:
        if name == "apply":
            given = (_read_only(given[0]), *given[1:])
        try:
            answer = method.__get__(self, type(self))(*given)
        except InputError:
            raise
        except (Exception, SystemExit) as error:  # a user's own method may fail in any way
            inner = error.__traceback__.tb_next if error.__traceback__ else None
            raise wrong(self, _raised(name, error), inner and inner.tb_lineno) from error
        try:
            return checked(self, given, answer)
        except (ValueError, TypeError) as error:
            raise wrong(self, f"{name} returns {error}") from error

    return asked


def _read_only(signal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a view of what others go on to use."""
    view = signal.view()
    view.flags.writeable = False
    return view


def _raised(name: str, error: BaseException) -> str:
    """Say what a method raised."""
    if "read-only" in str(error):
        return f"{name} changes in place what it is given: let it return a new array"
    return f"{name} raised {one_line(error)}"


def _signal(_: Any, given: Any, answer: Any) -> NDArray[np.float64]:
    """Return a stage's signal as an array that may be changed."""
    before = given[0]
    if not isinstance(answer, np.ndarray) or answer.shape != before.shape:
        is_array = isinstance(answer, np.ndarray)
        gave = f"an array of shape {answer.shape}" if is_array else _shown(answer)
        raise ValueError(f"{gave} where one of shape {before.shape} is wanted")
    if answer.dtype.kind not in "fiub":
        raise ValueError(f"{answer.dtype} where real numbers are wanted")
    after = np.asarray(answer, dtype=np.float64)
    if not np.all(np.isfinite(after)) and np.all(np.isfinite(before)):
        row = int(np.argmin(np.isfinite(after)))
        raise ValueError(f"{after[row]} in row {row}, which no speed or phase can be")
    return after if after.flags.writeable else after.copy()


def _grids(effect: Any, _: Any, answer: Any) -> dict[str, NDArray[np.float64]]:
    """Return a grid for each parameter that is scanned, and for no other."""
    scanned = {p.name for p in effect.parameters if p.scanned}
    if not isinstance(answer, Mapping) or set(answer) != scanned:
        wanted = ", ".join(sorted(scanned)) or "nothing"
        raise ValueError(f"{_shown(answer)} where a dict of the scanned ({wanted}) is wanted")
    grids = {name: np.asarray(values, dtype=np.float64) for name, values in answer.items()}
    for name, values in grids.items():
        if values.ndim != 1 or not values.size:
            raise ValueError(f"no values for {name}")
        if not np.all(np.isfinite(values)) or np.any(np.diff(values) < 0.0):
            raise ValueError(f"values for {name} that do not rise")
    return grids


def _reason(_: Any, __: Any, answer: Any) -> str | None:
    """Return why runs cannot show a cause, or None."""
    if answer is None or (isinstance(answer, str) and answer):
        return answer
    raise ValueError(f"{_shown(answer)} where a reason or None is wanted")


def _linear(_: Any, __: Any, answer: Any) -> LinearPart:
    """Return a linear part that a run can go through."""
    if not isinstance(answer, LinearPart):
        raise TypeError(f"{_shown(answer)} where a LinearPart is wanted")
    if not np.all(np.isfinite(answer.a)) or not np.all(np.isfinite(answer.b)):
        raise ValueError("a linear part whose a or b are no numbers")
    return answer


def _values(effect: Any, __: Any, answer: Any) -> dict[str, float] | None:
    """Return a value for each parameter, or None."""
    names = {p.name for p in effect.parameters}
    if answer is not None and not (isinstance(answer, Mapping) and set(answer) == names):
        raise ValueError(f"{_shown(answer)} where None or a value for each parameter is wanted")
    return None if answer is None else {name: float(value) for name, value in answer.items()}


def _as_it_is(_: Any, __: Any, answer: Any) -> Any:
    return answer


def _shown(answer: Any) -> str:
    """Return a value as a few words."""
    text = " ".join(repr(answer).split())
    return text if len(text) <= 60 else f"{text[:57]}..."


_ASKED: Final[dict[str, Callable[[Any, Any, Any], Any]]] = {
    "apply": _signal,
    "linear_part": _linear,
    "grid": _grids,
    "untestable": _reason,
    "built_in": _values,
    "habitual": _as_it_is,
    "alike": _as_it_is,
    "beneath": _as_it_is,
    "weigh": _as_it_is,
}
