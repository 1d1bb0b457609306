"""The panel on the terminal while a sweep runs; the sweep itself never waits for the terminal."""

import os
import queue
import threading
import time
from contextlib import suppress
from types import TracebackType
from typing import Final, Self, TextIO

from usmbench.cli.live_curve import BOTH, FALLING, NOW, RISING, LiveCurve
from usmbench.cli.live_text import LEGEND_ROW, LatestWindow, panel_lines
from usmbench.report.plain_text import printable
from usmbench.settings.bench import InterlockSettings
from usmbench.sweep.observer import Standing
from usmbench.sweep.rows import PairRow, WindowRow

REDRAW_S: Final = 0.25
# A terminal that was stopped with Ctrl-S takes nothing; the sweep ends all the same.
_LAST_DRAW_S: Final = 1.0
_COLOURS: Final = {RISING: "36", FALLING: "33", BOTH: "32", NOW: "1", "·": "2"}


class LivePanel:
    """Shows a sweep on a terminal, redrawn in place by a thread of its own.

    As a context manager it draws the last state when it ends. Where the stream is no terminal
    nothing is written, and no thread runs.

    Parameters
    ----------
    stream
        Where it goes.
    title
        What is measured, and where to; a plan's name may be somebody else's.
    limits
        When the drive goes off.
    """

    def __init__(self, stream: TextIO, title: str, limits: InterlockSettings):
        self._stream = stream
        self._title = printable(title)
        self._limits = limits
        self._shown = stream.isatty() and os.environ.get("TERM") != "dumb"
        self._colours = {} if os.environ.get("NO_COLOR") else _COLOURS
        self._curve = LiveCurve()
        self._pairs: queue.SimpleQueue[PairRow] = queue.SimpleQueue()
        self._latest: tuple[WindowRow, Standing, int] | None = None
        self._windows = 0
        self._begun_s = time.monotonic()
        self._lines_drawn = 0
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._draw_on, name="panel", daemon=True)

    def __enter__(self) -> Self:
        if self._shown:
            self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._ended.set()
        if self._shown:
            self._thread.join(_LAST_DRAW_S)

    def window(self, row: WindowRow, standing: Standing) -> None:
        """Take one window; it is drawn with the next redraw, or passed over.

        Parameters
        ----------
        row
            The window.
        standing
            Where the sweep stands.
        """
        self._windows += 1
        self._latest = (row, standing, self._windows)

    def settled(self, pair: PairRow) -> None:
        """Take one pair.

        Parameters
        ----------
        pair
            The pair.
        """
        if self._shown:
            self._pairs.put(pair)

    def _draw_on(self) -> None:
        # A terminal that has gone is no reason to stop the sweep.
        with suppress(OSError):
            while not self._ended.wait(REDRAW_S):
                self._draw()
            self._draw()
            if self._latest is not None:
                self._write("\n")

    def _draw(self) -> None:
        """Draw what is known now over what was drawn before."""
        while not self._pairs.empty():
            self._curve.add(self._pairs.get())
        if self._latest is None:
            return
        row, standing, windows = self._latest
        if standing.waiting_for_load and not self._lines_drawn:
            return
        columns, rows = self._size()
        seen = LatestWindow(row, standing, windows, time.monotonic() - self._begun_s)
        lines = panel_lines(self._title, seen, self._limits, self._curve, columns, rows)
        words, curve = lines[:LEGEND_ROW], lines[LEGEND_ROW:]
        text = "\x1b[K\n".join([*words, *map(self._coloured, curve)]) + "\x1b[K"
        if standing.waiting_for_load:
            # The operator's question stands one line beneath and stays, with the cursor behind it;
            # what is drawn after the answer begins under it.
            self._write(f"\x1b7\x1b[{self._lines_drawn}A\r{text}\x1b8")
            self._lines_drawn = 0
            return
        self._write(self._to_first_line() + text + "\x1b[J")
        self._lines_drawn = len(lines)

    def _to_first_line(self) -> str:
        """Return what moves to the first line of the panel."""
        if self._lines_drawn > 1:
            return f"\x1b[{self._lines_drawn - 1}A\r"
        return "\r"

    def _coloured(self, line: str) -> str:
        for mark, colour in self._colours.items():
            line = line.replace(mark, f"\x1b[{colour}m{mark}\x1b[0m")
        return line

    def _size(self) -> tuple[int, int]:
        size = os.get_terminal_size(self._stream.fileno())
        # A terminal that does not know its size says 0.
        return size.columns or 80, size.lines or 24

    def _write(self, text: str) -> None:
        """Write past the stream's buffer: its lock would be held while the terminal is stopped."""
        data = text.encode(self._stream.encoding, "replace")
        while data:
            data = data[os.write(self._stream.fileno(), data) :]
