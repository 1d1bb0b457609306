"""The board's serial port as a pseudo-terminal, with bytes that take the time of a real line."""

import contextlib
import os
import select
import threading
import time
import tty
from collections import deque
from typing import Final

from hil_sim.clock import Clock
from hil_sim.testbed import Testbed

_READ_SIZE: Final = 4096
_IDLE_S: Final = 0.01
# A sleep ends up to some 0.1 ms late; the last byte of a reply is what the host waits for.
_SPIN_S: Final = 150e-6
_JOIN_TIMEOUT_S: Final = 5.0


class PtyEdge:
    """A pseudo-terminal in front of the emulated board; a host may open and close it at will.

    In real time each byte of a reply is written when it would have ended on the line. In lock step
    replies are handed over at once, but for bytes that a fault holds up.

    Parameters
    ----------
    testbed
        Where the board is.
    clock
        Lock step or real time.

    Attributes
    ----------
    path
        What a host opens.
    """

    def __init__(self, testbed: Testbed, clock: Clock):
        self._testbed = testbed
        self._clock = clock
        # Our own hold on the host's end keeps a host that closes it from hanging up the line.
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.path = os.ttyname(self._slave)
        self._wake_reader, self._wake_writer = os.pipe()
        self._outgoing: deque[tuple[float, int]] = deque()
        self._stopping = False
        self._thread = threading.Thread(target=self._run, name="board pty", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Close the pseudo-terminal and end its thread; safe to call twice."""
        if self._stopping:
            return
        self._stopping = True
        os.write(self._wake_writer, b"\0")
        self._thread.join(_JOIN_TIMEOUT_S)
        os.close(self._wake_reader)
        os.close(self._wake_writer)

    def _run(self) -> None:
        try:
            while not self._stopping and self._clock.now_s() < self._testbed.port_gone_s:
                self._turn()
        finally:
            os.close(self._master)
            os.close(self._slave)

    def _turn(self) -> None:
        """Wait for bytes from the host or for the next byte's time, and serve what is due."""
        readable, _, _ = select.select(
            [self._master, self._wake_reader], [], [], self._sleep_s(time.monotonic())
        )
        if self._master in readable:
            self._take()
        if len(self._outgoing) == 1 and self._sleep_s(time.monotonic()) == 0.0:
            while time.monotonic() < self._outgoing[0][0]:
                pass
        self._send_due(time.monotonic())

    def _sleep_s(self, now_s: float) -> float:
        if not self._outgoing:
            return _IDLE_S
        early_s = _SPIN_S if len(self._outgoing) == 1 else 0.0
        return min(max(0.0, self._outgoing[0][0] - early_s - now_s), _IDLE_S)

    def _take(self) -> None:
        """Pass on what the host wrote and queue the board's answer."""
        data = os.read(self._master, _READ_SIZE)
        wall_s, at_s = time.monotonic(), self._clock.now_s()
        if self._clock.lock_step:
            # The reply before was handed over early; on the line the host would still be taking it.
            at_s = max(at_s, self._testbed.answered_s)
        for arrival in self._testbed.host_bytes(data, at_s):
            paced = arrival.late or not self._clock.lock_step
            due_s = wall_s + (arrival.time_s - at_s if paced else 0.0)
            self._outgoing.append((due_s, arrival.byte))

    def _send_due(self, now_s: float) -> None:
        due = bytearray()
        while self._outgoing and self._outgoing[0][0] <= now_s:
            due.append(self._outgoing.popleft()[1])
        if due:
            # Nobody reads: bytes are lost once the buffer is full, as on a line.
            with contextlib.suppress(BlockingIOError):
                os.write(self._master, due)
