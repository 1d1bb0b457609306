"""What a run.yaml must say for its run to be found."""

from dataclasses import dataclass
from datetime import date
from fnmatch import fnmatchcase

from usmbench.errors import InputError
from usmbench.runs.meta_blocks import MetaBlocks


@dataclass(frozen=True, slots=True)
class Condition:
    """What a run must say to be found.

    Parameters
    ----------
    key
        A key of run.yaml, with dots between the levels; lists stand for their items.
    value
        What is to be there: a number or text, in which * and ? stand for any letters and one.
    """

    key: str
    value: str

    def holds(self, meta: MetaBlocks) -> bool:
        """Return whether a run fulfils the condition.

        Parameters
        ----------
        meta
            What its run.yaml says.

        Raises
        ------
        usmbench.errors.InputError
            run.yaml cannot be read.
        """
        return any(self._fits(value) for value in meta.values(self.key))

    def _fits(self, value: object) -> bool:
        if isinstance(value, int | float) and not isinstance(value, bool):
            number = _number(self.value)
            return number is not None and number == value
        text = value.isoformat() if isinstance(value, date) else str(value)
        return fnmatchcase(text.casefold(), self.value.casefold())


def parse_condition(text: str) -> Condition:
    """Return the condition that KEY=VALUE says.

    Parameters
    ----------
    text
        Such as ``plan.name=phase-sweep`` or ``exit=failed*``.

    Raises
    ------
    usmbench.errors.InputError
        There is no key or no equals sign.
    """
    key, equals, value = text.partition("=")
    if not key or not equals:
        raise InputError(f"--find {text!r} is not KEY=VALUE, such as plan.name=phase-sweep")
    return Condition(key, value)


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
