"""The firmware's image in gpsim, as a process that is told what to do line by line."""

import contextlib
import json
import os
import select
import subprocess
import time
from pathlib import Path
from typing import IO, Any, Final, Self, cast

from usmbench.errors import InputError, PortError

CYCLES_PER_SECOND: Final = 7_372_800
"""Instruction cycles of the board's processor in a second."""
BUILD: Final = Path(__file__).resolve().parent.parent / "firmware" / "build"
"""Where `make -C firmware` leaves the bridge and the image."""

_DEADLINE_S: Final = 60.0
_READ_SIZE: Final = 65536

Event = dict[str, Any]
"""What happened: "cycle", and one of "byte", "chips" with "word" and "latched", "enable", "sync",
"reset", "error"."""


class GpsimBridge:
    """The bridge under command; used as a context manager that ends it.

    Parameters
    ----------
    build
        Folder of the bridge and the image.

    Attributes
    ----------
    cycle
        Instruction cycles simulated since power-on.

    Raises
    ------
    usmbench.errors.InputError
        Bridge or image are not there.
    """

    def __init__(self, build: Path = BUILD):
        bridge, image = build / "bridge", build / "generator.hex"
        for file in (bridge, image):
            if not file.is_file():
                raise InputError(f"{file} is missing; build it with: make -C firmware")
        self.cycle = 0
        self._unread = b""
        self._process = subprocess.Popen(  # noqa: S603 - what our own Makefile built
            [bridge, image],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            bufsize=0,
            start_new_session=True,  # Ctrl-C is for us, who end it
        )
        self._stdin = cast("IO[bytes]", self._process.stdin)
        self._stdout = cast("IO[bytes]", self._process.stdout)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the process; safe to call twice."""
        self._process.kill()
        self._process.wait(_DEADLINE_S)
        for stream in (self._stdin, self._stdout):
            with contextlib.suppress(OSError):
                stream.close()

    def command(self, *lines: str) -> list[Event]:
        """Give commands, and return what happened until the last of them was done.

        Parameters
        ----------
        lines
            Commands as firmware/bridge/main.cc lists them.

        Raises
        ------
        usmbench.errors.PortError
            The bridge has ended, or does not answer.
        """
        try:
            self._stdin.write("".join(f"{line}\n" for line in lines).encode("ascii"))
        except OSError as error:
            raise PortError(f"the firmware's simulator has ended: {error}") from error
        events: list[Event] = []
        for _ in lines:
            events += self._until_done()
        return events

    def _until_done(self) -> list[Event]:
        deadline_s = time.monotonic() + _DEADLINE_S
        events: list[Event] = []
        while True:
            event = json.loads(self._line(deadline_s))
            self.cycle = event["cycle"]
            if "done" in event:
                return events
            events.append(event)

    def _line(self, deadline_s: float) -> bytes:
        """Return the next line the bridge prints."""
        while b"\n" not in self._unread:
            left_s = deadline_s - time.monotonic()
            readable, _, _ = select.select([self._stdout], [], [], max(0.0, left_s))
            if not readable:
                raise PortError(f"the firmware's simulator is silent for {_DEADLINE_S:g} s")
            data = os.read(self._stdout.fileno(), _READ_SIZE)
            if not data:
                raise PortError("the firmware's simulator has ended; run it by hand to see why")
            self._unread += data
        line, self._unread = self._unread.split(b"\n", 1)
        return line
