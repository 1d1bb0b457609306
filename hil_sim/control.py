"""The hand on the running testbed: one JSON object a line on standard input."""

import json
import os
import select
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any, Final

from hil_sim.testbed import Testbed
from usmbench.errors import InputError

_READ_SIZE: Final = 65_536
_STDIN: Final = 0


def answer(testbed: Testbed, line: bytes) -> dict[str, Any]:
    """Do what a line asks for and return the answer.

    Parameters
    ----------
    testbed
        What is under control.
    line
        A JSON object; `load_nm` sets the load torque in N·m, an empty object asks for the time.
    """
    try:
        wish = _checked(json.loads(line))
        if "load_nm" in wish:
            testbed.set_load(wish["load_nm"])
    except ValueError:
        return {"ok": False, "error": "this is not JSON"}
    except InputError as error:
        return {"ok": False, "error": str(error)}
    return {"ok": True, "time_s": testbed.time_s}


def _checked(wish: Any) -> dict[str, float]:
    """Hold what was asked for against what there is."""
    if not isinstance(wish, dict) or not wish.keys() <= {"load_nm"}:
        raise InputError("expected an object with load_nm")
    for name, value in wish.items():
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise InputError(f"{name} must be a number")
    return wish


@contextmanager
def stop_signals() -> Iterator[int]:
    """Catch SIGTERM and SIGINT for as long as the context lasts.

    Yields
    ------
    int
        File descriptor that has something to read once one of them came.
    """
    reader, writer = os.pipe()

    def note(_number: int, _frame: FrameType | None) -> None:
        os.write(writer, b"\0")

    previous = {number: signal.signal(number, note) for number in (signal.SIGTERM, signal.SIGINT)}
    try:
        yield reader
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)
        os.close(reader)
        os.close(writer)


def run_until_stopped(testbed: Testbed, stop: int, *, stdin_control: bool) -> None:
    """Return when asked to stop or, under control from standard input, at its end.

    Parameters
    ----------
    testbed
        What is under control.
    stop
        File descriptor from `stop_signals`.
    stdin_control
        Whether standard input is read, so that the death of a parent ends this process too.
    """
    watched = [stop, _STDIN] if stdin_control else [stop]
    unfinished = b""
    while True:
        readable, _, _ = select.select(watched, [], [])
        if stop in readable:
            return
        data = os.read(_STDIN, _READ_SIZE)
        if not data:
            return
        *lines, unfinished = (unfinished + data).split(b"\n")
        for line in lines:
            print(json.dumps(answer(testbed, line)), flush=True)
