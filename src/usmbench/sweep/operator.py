"""Who sets the load: a person at the terminal, or the simulated testbed."""

import os
import select
import sys
import threading
from contextlib import suppress
from typing import Protocol, TextIO

from usmbench.errors import BenchError

_MOST_READS = 4096  # lines that wait in a terminal; a pipe may never run dry


class Operator(Protocol):
    """Sets the load torque while the sweep goes on watching the bench."""

    def set_load(self, torque_nm: float, *, ask: bool) -> None:
        """Begin to set a load; `ask` is False where by the plan it is there and stays."""

    def load_is_set(self) -> bool:
        """Return whether the load begun last is set; never waits."""


class TerminalOperator:
    """A person, asked on standard error, who answers with Enter.

    Parameters
    ----------
    output
        Where the question goes; None is standard error.
    input_fd
        File descriptor the answer comes from; 0 is standard input.
    """

    def __init__(self, output: TextIO | None = None, input_fd: int = 0):
        self._output = sys.stderr if output is None else output
        self._input_fd = input_fd
        self._answered = threading.Event()
        self._reader: threading.Thread | None = None
        self._asked = False

    def set_load(self, torque_nm: float, *, ask: bool) -> None:
        """Ask for a load.

        Parameters
        ----------
        torque_nm
            The load torque.
        ask
            Whether anything is to be done: a constant load is there already.

        Raises
        ------
        usmbench.errors.BenchError
            The question cannot be shown.
        """
        self._asked = ask
        if not ask:
            return
        # Enter pressed during a pass must not start the drive under somebody's hands.
        if self._reader is None:
            self._drop_unread()
        self._answered.clear()
        try:
            self._output.write(
                f"\nThe drive is off. Set the load to {torque_nm:g} N·m, then Enter: "
            )
            self._output.flush()
        except OSError as error:
            said = f"standard error cannot be written ({error.strerror or error})"
            raise _nobody(said) from error
        if self._reader is None:
            # A thread of its own, since nothing can be waited for between two windows; os.read,
            # since a daemon thread inside sys.stdin would hold its lock as the program ends.
            self._reader = threading.Thread(target=self._read, name="operator", daemon=True)
            self._reader.start()

    def _drop_unread(self) -> None:
        """Drop what was typed before there was a reader."""
        # Windows can tell of sockets only.
        with suppress(OSError):
            for _ in range(_MOST_READS):
                waiting, _, _ = select.select([self._input_fd], [], [], 0.0)
                if not waiting or not os.read(self._input_fd, 1024):
                    return

    def _read(self) -> None:
        with suppress(OSError):
            while typed := os.read(self._input_fd, 1024):
                if b"\n" in typed:
                    self._answered.set()

    def load_is_set(self) -> bool:
        """Return whether Enter was pressed.

        Raises
        ------
        usmbench.errors.BenchError
            Standard input has ended: nobody is there to set the load.
        """
        if not self._asked:
            return True
        # Before the answer, which may be the last word.
        ended = self._reader is not None and not self._reader.is_alive()
        if self._answered.is_set():
            self._asked = False
            return True
        if ended:
            raise _nobody("standard input has ended")
        return False


def _nobody(why: str) -> BenchError:
    return BenchError(
        f"nobody can be asked to set the load, {why}; run this in a terminal, or write "
        "load: constant into a plan of one torque"
    )
