"""Ctrl-C kept for the next window's end, so that it never cuts a frame, a row or the drive-off."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

# SIGTERM and a closed terminal must stop the motor as well.
_NAMES = ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")


class Interrupts:
    """Whether the user wants to stop."""

    def __init__(self) -> None:
        self._wanted = False

    def want(self, _number: int = 0, _frame: FrameType | None = None) -> None:
        """Note the wish; a signal handler."""
        self._wanted = True

    def check(self) -> None:
        """Stop where that is wanted.

        Raises
        ------
        KeyboardInterrupt
            A signal has come since the last check.
        """
        if self._wanted:
            self._wanted = False
            raise KeyboardInterrupt


_outermost: list[Interrupts] = []


@contextmanager
def deferred_interrupts() -> Iterator[Interrupts]:
    """Keep signals that would end the process until `check` is called.

    A second Ctrl-C finds the first one's wish and changes nothing. Nested use shares the outermost
    guard; outside the main thread, where no signal arrives, nothing is installed.
    """
    interrupts = Interrupts()
    if threading.current_thread() is not threading.main_thread():
        yield interrupts
        return
    if _outermost:
        yield _outermost[0]
        return
    before: dict[int, Any] = {}
    _outermost.append(interrupts)
    try:
        for number in _deferrable():
            before[number] = signal.signal(number, interrupts.want)
        yield interrupts
    finally:
        _outermost.clear()
        for number, handler in before.items():
            signal.signal(number, handler)


def _deferrable() -> Iterator[int]:
    """Yield the signals of this system that would end the process."""
    for name in _NAMES:
        number = getattr(signal, name, None)
        # nohup's wish that a closed terminal be ignored is kept.
        if number is not None and not (name == "SIGHUP" and _is_ignored(number)):
            yield number


def _is_ignored(number: int) -> bool:
    return signal.getsignal(number) is signal.SIG_IGN
