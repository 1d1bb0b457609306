"""Who sets the load: a person at the terminal, or the simulated testbed."""

import os
import queue
import sys
import threading
from typing import Protocol, TextIO

from usmbench.errors import BenchError


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
        self._answers: queue.SimpleQueue[bytes] = queue.SimpleQueue()
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
        """
        self._asked = ask
        if not ask:
            return
        self._output.write(f"\nThe drive is off. Set the load to {torque_nm:g} N·m, then Enter: ")
        self._output.flush()
        if self._reader is None:
            # A thread of its own, since nothing can be waited for between two windows; os.read,
            # since a daemon thread inside sys.stdin would hold its lock as the program ends.
            self._reader = threading.Thread(target=self._read, name="operator", daemon=True)
            self._reader.start()

    def _read(self) -> None:
        answer = b"?"
        while answer:
            try:
                answer = os.read(self._input_fd, 1024)
            except OSError:
                answer = b""
            if not answer or b"\n" in answer:
                self._answers.put(answer)

    def load_is_set(self) -> bool:
        """Return whether Enter was pressed.

        Raises
        ------
        usmbench.errors.BenchError
            Standard input has ended: nobody is there to set the load.
        """
        if not self._asked:
            return True
        try:
            answer = self._answers.get_nowait()
        except queue.Empty:
            return False
        if not answer:
            raise BenchError(
                "nobody can be asked to set the load, standard input has ended; run the sweep in "
                "a terminal, or write load: constant into the plan"
            )
        self._asked = False
        return True
