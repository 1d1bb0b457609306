"""What a check saw, and what is to be done about it."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

Status = Literal["ok", "warning", "failed", "skipped"]


@dataclass(frozen=True, slots=True)
class Finding:
    """The outcome of one check.

    Parameters
    ----------
    check
        What was looked at, such as "encoder direction".
    status
        "ok"; "warning", the bench can be used; "failed", it cannot; "skipped", not looked at.
    saw
        What was seen, with its numbers.
    do
        What to do; empty where nothing is to be done.
    """

    check: str
    status: Status
    saw: str
    do: str = ""


def skipped(checks: Iterable[str], why: str) -> Iterator[Finding]:
    """Yield the findings of checks that another one's failure makes impossible.

    Parameters
    ----------
    checks
        Their names.
    why
        What is missing.
    """
    for check in checks:
        yield Finding(check, "skipped", why)
