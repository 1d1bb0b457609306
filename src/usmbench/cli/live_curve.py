"""The φ–ω curve in characters: small, and rising and falling passes apart without colour."""

from math import ceil, log10

from usmbench.sweep.rows import PairRow

RISING, FALLING, BOTH, NOW = "▲", "▼", "◆", "●"
_LABEL_WIDTH = 7
_PHASE_BIN_DEG = 0.5
_PHASE_STEP_DEG = 45.0
_STEPS = (1.0, 2.0, 5.0, 10.0)


class LiveCurve:
    """The pairs of the operating point under way; memory is bounded by the bins of φ."""

    def __init__(self) -> None:
        self._point: tuple[float, float] | None = None
        self._speeds: dict[tuple[int, int], float] = {}

    def add(self, pair: PairRow) -> None:
        """Take one pair; the first of another operating point starts a new curve.

        Parameters
        ----------
        pair
            The pair.
        """
        point = (pair.frequency_hz, pair.torque_nm)
        if point != self._point:
            self._point = point
            self._speeds.clear()
        bin_number = round(pair.phase_deg / _PHASE_BIN_DEG)
        self._speeds[pair.direction, bin_number] = pair.speed_rad_s

    def lines(self, columns: int, rows: int, now: tuple[float, float]) -> list[str]:
        """Draw the curve.

        Parameters
        ----------
        columns, rows
            Room for it, in characters, axes included.
        now
            Phase in degrees and speed in rad/s of the latest window.

        Returns
        -------
        list of str
            One string a row, none longer than `columns`.
        """
        width, height = columns - _LABEL_WIDTH - 1, rows - 2
        points = [(n * _PHASE_BIN_DEG, w, sign) for (sign, n), w in self._speeds.items()]
        phase_end_deg = _phase_end(max(abs(now[0]), *(abs(p[0]) for p in points), 1.0))
        speed_end_rad_s = _round_up(max(abs(now[1]), *(abs(p[1]) for p in points), 1.0))
        cells = [[" "] * width for _ in range(height)]
        _draw_axes(cells)

        def cell(phase_deg: float, speed_rad_s: float) -> tuple[int, int]:
            across = (phase_deg / phase_end_deg + 1.0) / 2.0
            up = (1.0 - speed_rad_s / speed_end_rad_s) / 2.0
            return round(up * (height - 1)), round(across * (width - 1))

        for phase_deg, speed_rad_s, sign in points:
            row, column = cell(phase_deg, speed_rad_s)
            mark = RISING if sign > 0 else FALLING
            taken = cells[row][column] in {RISING, FALLING, BOTH} - {mark}
            cells[row][column] = BOTH if taken else mark
        row, column = cell(*now)
        cells[row][column] = NOW
        labels = _speed_labels(height, speed_end_rad_s)
        drawn = [
            f"{label:>{_LABEL_WIDTH}}┤{''.join(line)}"
            for label, line in zip(labels, cells, strict=True)
        ]
        return [*drawn, *_phase_axis(width, phase_end_deg)]


def _draw_axes(cells: list[list[str]]) -> None:
    middle, zero = len(cells) // 2, len(cells[0]) // 2
    cells[middle] = ["·"] * len(cells[0])
    for line in cells:
        line[zero] = "·"


def _phase_end(phase_deg: float) -> float:
    return _PHASE_STEP_DEG * ceil(phase_deg / _PHASE_STEP_DEG)


def _round_up(value: float) -> float:
    """Return the next 1, 2, 5 or 10 times a power of ten, with a little room."""
    scale = 10.0 ** (ceil(log10(value)) - 1)
    return next((step * scale for step in _STEPS if value <= step * scale * 1.05), 20.0 * scale)


def _speed_labels(height: int, end_rad_s: float) -> list[str]:
    labels = [""] * height
    labels[0], labels[height // 2], labels[-1] = f"{end_rad_s:g}", "0", f"{-end_rad_s:g}"
    return labels


def _phase_axis(width: int, end_deg: float) -> list[str]:
    left, right = f"{-end_deg:g}°", f"{end_deg:g}°"
    gap = width // 2 - len(left)
    numbers = left + " " * gap + "0"
    numbers += " " * (width - len(numbers) - len(right)) + right
    return [" " * _LABEL_WIDTH + "└" + "─" * width, " " * (_LABEL_WIDTH + 1) + numbers]
