"""The progress line on a terminal."""

import time
from collections.abc import Callable
from typing import TextIO

from usmbench.sweep.rows import WindowRow

REFRESH_S = 0.2


class ProgressLine:
    """One line that is written over: time remaining and the latest (φ, ω).

    Parameters
    ----------
    stream
        Where it goes; nothing is written where that is no terminal.
    clock
        Seconds.
    """

    def __init__(self, stream: TextIO, clock: Callable[[], float] = time.monotonic):
        self._stream = stream
        self._clock = clock
        self._shown = stream.isatty()
        self._windows = 0
        self._begun_s = clock()
        self._next_s = self._begun_s

    def window(self, row: WindowRow, windows_left: int) -> None:
        """Take one window; refresh the line a few times a second.

        Parameters
        ----------
        row
            The window.
        windows_left
            Windows that the plan still has.
        """
        self._windows += 1
        if not self._shown or self._clock() < self._next_s:
            return
        now_s = self._clock()
        self._next_s = now_s + REFRESH_S
        # By the pace so far: a simulated bench is faster than its own sample clock.
        left_s = round(windows_left * (now_s - self._begun_s) / self._windows)
        self._stream.write(
            f"\r{left_s // 60:3d}:{left_s % 60:02d} left   φ = {row.phase_deg:7.2f}°   "
            f"ω = {row.speed_rad_s:7.3f} rad/s   pass {row.sweep} \x1b[K"
        )
        self._stream.flush()

    def close(self) -> None:
        """End the line, so that what follows begins on its own."""
        if self._shown and self._windows:
            self._stream.write("\r\x1b[K")
            self._stream.flush()
