import io

from usmbench.sweep.progress import ProgressLine
from usmbench.sweep.rows import WindowRow

ROW = WindowRow(1.0, 45.0, 7.125, 41_000.0, 0.0, 0.0, 0.01, 2, 1, 7.1, 1)


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_time_remaining_is_by_the_pace_so_far() -> None:
    terminal, now_s = Terminal(), [0.0]
    progress = ProgressLine(terminal, lambda: now_s[0])
    for n in range(1, 101):
        now_s[0] = 0.02 * n
        progress.window(ROW, 10_000 - n)
    progress.close()
    lines = terminal.getvalue().split("\r")
    # 9900 windows at 20 ms, though each is 10 ms of sample time.
    assert any("3:18 left" in line for line in lines)
    assert "φ =   45.00°" in lines[1]
    assert "ω =   7.125 rad/s" in lines[1]
    assert len(lines) <= 2.0 / 0.2 + 3
    assert "\n" not in terminal.getvalue()


def test_no_terminal_no_progress() -> None:
    stream = io.StringIO()
    progress = ProgressLine(stream)
    progress.window(ROW, 10)
    progress.close()
    assert stream.getvalue() == ""
