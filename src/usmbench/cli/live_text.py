"""What the panel on the terminal says, line by line, apart from how it gets there."""

from collections.abc import Iterator
from dataclasses import dataclass

from usmbench.cli.live_curve import BOTH, FALLING, NOW, RISING, LiveCurve
from usmbench.settings.bench import InterlockSettings
from usmbench.sweep.observer import Standing
from usmbench.sweep.rows import WindowRow

CURVE_ROWS = 15
CURVE_COLUMNS = 76
WORDS_ROWS = 5
LEGEND_ROW = WORDS_ROWS - 1  # what the marks of the curve mean; the curve follows
# Below this the panel is one line.
LEAST_ROWS, LEAST_COLUMNS = CURVE_ROWS + WORDS_ROWS + 1, 60
_NEAR_LIMIT = 0.8
_BAR = 24


@dataclass(frozen=True, slots=True)
class LatestWindow:
    """The latest window and what led to it.

    Parameters
    ----------
    row
        The window.
    standing
        Where the sweep stands.
    windows
        Windows so far.
    elapsed_s
        Time since the first of them, on the clock on the wall.
    """

    row: WindowRow
    standing: Standing
    windows: int
    elapsed_s: float

    @property
    def left_s(self) -> int:
        """Time remaining, by the pace so far: a simulated bench outruns its own sample clock."""
        return round(self.standing.windows_left * self.elapsed_s / max(self.windows, 1))


def panel_lines(
    title: str,
    seen: LatestWindow,
    limits: InterlockSettings,
    curve: LiveCurve,
    columns: int,
    rows: int,
) -> list[str]:
    """Return the panel.

    Parameters
    ----------
    title
        What is measured, and where to.
    seen
        The latest window.
    limits
        When the drive goes off.
    curve
        The pairs so far.
    columns, rows
        Size of the terminal; where it is too small the panel is one line.
    """
    if columns < LEAST_COLUMNS or rows < LEAST_ROWS:
        return [one_line(seen)[: columns - 1]]
    row = seen.row
    point = f"{row.frequency_hz / 1000:.3f} kHz  {row.torque_nm:g} N·m"
    words = [
        title,
        f"{_bar(seen)}  {_time(seen.left_s)} left   {state(seen)}",
        f"{point}   φ = {row.phase_deg:7.2f}°   ω = {row.speed_rad_s:7.3f} rad/s",
        "interlocks  " + "  ".join(interlocks(seen, limits)),
        f"ω (rad/s) against φ    {RISING} rising  {FALLING} falling  {BOTH} both  {NOW} now",
    ]
    room = min(columns - 1, CURVE_COLUMNS)
    drawn = curve.lines(room, CURVE_ROWS, (row.phase_deg, row.speed_rad_s))
    return [line[: columns - 1] for line in [*words, *drawn]]


def one_line(seen: LatestWindow) -> str:
    """Return the panel of a small terminal.

    Parameters
    ----------
    seen
        The latest window.
    """
    row = seen.row
    return (
        f"{_time(seen.left_s)} left   φ = {row.phase_deg:7.2f}°   "
        f"ω = {row.speed_rad_s:7.3f} rad/s   {state(seen)}"
    )


def state(seen: LatestWindow) -> str:
    """Say what the sweep is doing.

    Parameters
    ----------
    seen
        The latest window.
    """
    row = seen.row
    if seen.standing.waiting_for_load:
        return "drive off, waiting for the load"
    if not row.drive_on:
        return "drive off, watching the encoder"
    if row.sweep < 0:
        return "driving, warm-up"
    return f"driving, pass {row.sweep}, {'measuring' if row.settled else 'settling'}"


def interlocks(seen: LatestWindow, limits: InterlockSettings) -> Iterator[str]:
    """Yield each interlock that watches now: what it sees, and its limit.

    Parameters
    ----------
    seen
        The latest window.
    limits
        When the drive goes off.
    """
    row, watched = seen.row, seen.standing.interlocks
    speed_rad_s = abs(row.average_rad_s)
    yield _against("speed", speed_rad_s, limits.overspeed_rad_s, "rad/s")
    if row.drive_on:
        yield _against("still", watched.still_s, limits.no_motion_after_s, "s")
        yield _against("driven", watched.driven_s, limits.drive_time_max_s, "s")
    else:
        yield _against("motion", speed_rad_s, limits.motion_off_rad_s, "rad/s")
    if row.temperature_c is not None:
        yield _against("temperature", row.temperature_c, limits.temperature_max_c, "°C")


def _against(name: str, value: float, limit: float, unit: str) -> str:
    mark = "!" if value >= _NEAR_LIMIT * limit else ""
    shown = f"{value:.0f}" if limit >= 100.0 else f"{value:.1f}"
    return f"{mark}{name} {shown}/{limit:g} {unit}"


def _bar(seen: LatestWindow) -> str:
    share = seen.windows / max(seen.windows + seen.standing.windows_left, 1)
    done = round(share * _BAR)
    return f"[{'#' * done}{'-' * (_BAR - done)}] {100 * share:3.0f} %"


def _time(left_s: int) -> str:
    return f"{left_s // 60:d}:{left_s % 60:02d}"
