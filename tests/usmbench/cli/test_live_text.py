from dataclasses import replace

import pytest

from usmbench.cli.live_curve import LiveCurve
from usmbench.cli.live_text import LEAST_COLUMNS, LEAST_ROWS, LatestWindow, panel_lines
from usmbench.settings.bench import InterlockSettings
from usmbench.sweep.interlocks import InterlockState
from usmbench.sweep.observer import Standing
from usmbench.sweep.rows import WindowRow

ROW = WindowRow(1.0, 45.0, 7.125, 41_000.0, 0.1, 0.0, 0.01, 2, 1, 7.1, 1)
# 100 windows in 2 s, though each is 10 ms of sample time: 9900 more take 198 s.
SEEN = LatestWindow(ROW, Standing(9_900, InterlockState(still_s=0.45, driven_s=61.4)), 100, 2.0)


def panel(seen: LatestWindow, columns: int = 100, rows: int = 40) -> str:
    lines = panel_lines("plan → runs/one", seen, InterlockSettings(), LiveCurve(), columns, rows)
    assert len(lines) < rows
    assert max(map(len, lines)) < columns
    return "\n".join(lines)


def test_state_progress_time_remaining_and_the_latest_window() -> None:
    text = panel(SEEN)
    for said in (
        "plan → runs/one",
        "  1 %  3:18 left   driving, pass 2, measuring",
        "41.000 kHz  0.1 N·m   φ =   45.00°   ω =   7.125 rad/s",
    ):
        assert said in text


def test_interlocks_stand_beside_their_limits_and_the_near_ones_are_marked() -> None:
    text = panel(SEEN)
    assert "speed 7.1/16 rad/s  !still 0.5/0.5 s  driven 61/3600 s" in text
    assert "temperature" not in text
    assert "!temperature 65.0/70 °C" in panel(replace(SEEN, row=replace(ROW, temperature_c=65.0)))
    assert "motion 0.1/0.5 rad/s" in panel(
        replace(SEEN, row=replace(ROW, drive_on=0, average_rad_s=-0.1))
    )


@pytest.mark.parametrize(
    ("changed", "state"),
    [
        ({"drive_on": 0}, "drive off, watching the encoder"),
        ({"sweep": -1}, "driving, warm-up"),
        ({"settled": 0}, "driving, pass 2, settling"),
    ],
)
def test_what_the_sweep_is_doing(changed: dict[str, int], state: str) -> None:
    assert state in panel(replace(SEEN, row=replace(ROW, **changed)))


def test_waiting_for_the_operator_is_a_state() -> None:
    standing = replace(SEEN.standing, waiting_for_load=True)
    assert "waiting for the load" in panel(replace(SEEN, standing=standing))


@pytest.mark.parametrize(("columns", "rows"), [(LEAST_COLUMNS - 1, 40), (100, LEAST_ROWS - 1)])
def test_a_small_terminal_gets_one_line(columns: int, rows: int) -> None:
    text = panel(SEEN, columns, rows)
    assert "\n" not in text
    assert text.startswith("3:18 left   φ =   45.00°   ω =   7.125 rad/s")


def test_the_first_window_has_all_before_it() -> None:
    text = panel(replace(SEEN, standing=Standing(100, InterlockState()), windows=0, elapsed_s=0.0))
    assert "  0 %  0:00 left" in text
