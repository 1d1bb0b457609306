"""The panel on a pseudo-terminal, and what stands on its screen in the end."""

import fcntl
import io
import os
import re
import struct
import termios
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import TextIO

import pytest

from usmbench.cli import live_panel
from usmbench.cli.live_panel import REDRAW_S, LivePanel
from usmbench.settings.bench import InterlockSettings
from usmbench.sweep.interlocks import InterlockState
from usmbench.sweep.observer import Standing
from usmbench.sweep.rows import PairRow, WindowRow

ROW = WindowRow(1.0, 45.0, 7.125, 41_000.0, 0.0, 0.0, 0.01, 2, 1, 7.1, 1)
PAIR = PairRow(20.0, 41_000.0, 0.0, 7.1, 0.1, 10, 1, 1.0, 0, 1)
STANDING = Standing(9_900, InterlockState())
LIMITS = InterlockSettings()
QUESTION = "The drive is off. Set the load to 0.1 N·m, then Enter: "


class Terminal:
    """A pseudo-terminal of 100 × 30, read by a thread."""

    def __init__(self) -> None:
        self.master, slave = os.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 30, 100, 0, 0))
        self.stream: TextIO = os.fdopen(slave, "w", encoding="utf-8")
        self.received = b""
        self.reader = threading.Thread(target=self._read)

    def _read(self) -> None:
        with suppress(OSError):
            while data := os.read(self.master, 65536):
                self.received += data

    @property
    def text(self) -> str:
        return self.received.decode(errors="ignore")

    def close(self) -> None:
        self.stream.close()
        if self.reader.ident is not None:
            self.reader.join(5.0)
        os.close(self.master)


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> Iterator[Terminal]:
    monkeypatch.setenv("TERM", "xterm")
    terminal = Terminal()
    yield terminal
    terminal.close()


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live_panel, "REDRAW_S", 0.005)


def wait_for(true: Callable[[], object]) -> None:
    deadline_s = time.monotonic() + 5.0
    while not true():
        assert time.monotonic() < deadline_s, "waited in vain"
        time.sleep(0.002)


class Drawn:
    """Whether the panel was drawn so many times."""

    def __init__(self, terminal: Terminal, times: int):
        self.terminal, self.times = terminal, times

    def __call__(self) -> bool:
        return self.terminal.text.count("pass 2") >= self.times


def screen(text: str) -> list[str]:
    """Return the lines that stand on a screen after the text; it does not scroll."""
    lines, row, column, kept = [[" "] * 200 for _ in range(80)], 0, 0, (0, 0)
    for escape, letter in re.findall(r"(\x1b(?:\[[0-9;]*[A-Za-z]|[78]))|(.|[\r\n])", text):
        if escape.endswith("A"):
            row -= int(escape[2:-1])
        elif escape in {"\x1b[K", "\x1b[J"}:
            lines[row][column:] = [" "] * (200 - column)
            if escape == "\x1b[J":
                lines[row + 1 :] = [[" "] * 200 for _ in lines[row + 1 :]]
        elif escape == "\x1b7":
            kept = (row, column)
        elif escape == "\x1b8":
            row, column = kept
        elif letter == "\r":
            column = 0
        elif letter == "\n":
            row += 1
        elif letter:
            lines[row][column] = letter
            column += 1
    return [line for line in ("".join(cells).rstrip() for cells in lines) if line]


def test_it_is_drawn_in_place_and_left_standing(terminal: Terminal, quick: None) -> None:
    terminal.reader.start()
    with LivePanel(terminal.stream, "plan → runs/one", LIMITS) as panel:
        panel.settled(PAIR)
        for n in range(3):
            panel.window(ROW, Standing(9_900 - n, InterlockState()))
            wait_for(Drawn(terminal, n + 1))
    wait_for(lambda: terminal.text.endswith("\n"))
    lines = screen(terminal.text)
    assert lines[0] == "plan → runs/one"
    assert len(lines) == 20
    assert "▲" in "".join(lines[5:])


def test_at_most_four_redraws_a_second(terminal: Terminal) -> None:
    assert REDRAW_S >= 0.25
    terminal.reader.start()
    begun_s = time.monotonic()
    with LivePanel(terminal.stream, "title", LIMITS) as panel:
        while time.monotonic() < begun_s + 0.8:
            panel.window(ROW, STANDING)
            time.sleep(0.001)
    wait_for(lambda: terminal.text.endswith("\n"))
    # One more as it ends.
    assert terminal.text.count("title") <= (time.monotonic() - begun_s) / REDRAW_S + 1


def test_the_question_to_the_operator_stays(terminal: Terminal, quick: None) -> None:
    terminal.reader.start()
    with LivePanel(terminal.stream, "title", LIMITS) as panel:
        panel.window(ROW, STANDING)
        wait_for(lambda: "pass 2" in terminal.text)
        panel.window(ROW, Standing(9_000, InterlockState(), waiting_for_load=True))
        os.write(terminal.stream.fileno(), f"\n{QUESTION}".encode())
        wait_for(lambda: "waiting for the load" in terminal.text)
        for _ in range(5):
            panel.window(ROW, Standing(9_000, InterlockState(), waiting_for_load=True))
            time.sleep(0.01)
        os.write(terminal.stream.fileno(), b"\n")
        asked = len(terminal.text)
        panel.window(ROW, STANDING)
        wait_for(lambda: "pass 2" in terminal.text[asked:])
    wait_for(lambda: terminal.text.endswith("\n"))
    lines = screen(terminal.text)
    assert lines.count(QUESTION.rstrip()) == 1
    at = lines.index(QUESTION.rstrip())
    assert "waiting for the load" in lines[1]
    assert lines[at + 1] == "title"


def test_a_terminal_that_takes_nothing_does_not_hold_the_sweep(
    terminal: Terminal, quick: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live_panel, "_LAST_DRAW_S", 0.1)
    longest_s = 0.0
    with LivePanel(terminal.stream, "title", LIMITS) as panel:
        for _ in range(300):
            before_s = time.thread_time()
            panel.window(ROW, STANDING)
            longest_s = max(longest_s, time.thread_time() - before_s)
            time.sleep(0.002)
        left_s = time.monotonic()
    assert time.monotonic() - left_s < 2.0
    assert longest_s < 0.01
    # The thread ends with the terminal.
    terminal.reader.start()
    wait_for(lambda: "panel" not in [thread.name for thread in threading.enumerate()])


@pytest.mark.parametrize("dumb", [False, True])
def test_no_terminal_no_panel(
    terminal: Terminal, dumb: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    stream = terminal.stream if dumb else io.StringIO()
    monkeypatch.setenv("TERM", "dumb")
    with LivePanel(stream, "title", LIMITS) as panel:
        panel.window(ROW, STANDING)
        panel.settled(PAIR)
        assert "panel" not in [thread.name for thread in threading.enumerate()]
    terminal.reader.start()
    assert terminal.text == ""
    if isinstance(stream, io.StringIO):
        assert stream.getvalue() == ""


def test_colours_are_left_out_where_asked(
    terminal: Terminal, quick: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    terminal.reader.start()
    with LivePanel(terminal.stream, "title", LIMITS) as panel:
        panel.window(ROW, STANDING)
    wait_for(lambda: terminal.text.endswith("\n"))
    assert not re.search(r"\x1b\[[0-9;]*m", terminal.text)


def test_marks_are_coloured_in_the_curve_and_not_in_the_words(
    terminal: Terminal, quick: None
) -> None:
    terminal.reader.start()
    with LivePanel(terminal.stream, "a ▲ plan", LIMITS) as panel:
        panel.window(ROW, STANDING)
    wait_for(lambda: terminal.text.endswith("\n"))
    assert "a ▲ plan\x1b[K" in terminal.text
    assert "0 N·m" in terminal.text
    assert "\x1b[36m▲\x1b[0m rising" in terminal.text
    assert "\x1b[2m·\x1b[0m" in terminal.text


def test_a_title_from_a_file_cannot_speak_to_the_terminal(terminal: Terminal, quick: None) -> None:
    terminal.reader.start()
    with LivePanel(terminal.stream, "a\x1b[31mplan → runs/one", LIMITS) as panel:
        panel.window(ROW, STANDING)
    wait_for(lambda: terminal.text.endswith("\n"))
    assert "a�[31mplan" in terminal.text
