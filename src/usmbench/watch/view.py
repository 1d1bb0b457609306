"""What the live page shows of a run: everything that was seen, in bounded memory."""

import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.columns import PAIRS_FILE, RUN_FILE, WINDOWS_FILE
from usmbench.runs.pauses import without_pauses_s
from usmbench.runs.reader import read_run
from usmbench.runs.stop_request import STOP_FILE
from usmbench.watch.beside import Curve, Rows, SimulationBeside
from usmbench.watch.pair_curve import PairCurve
from usmbench.watch.run_head import RunHead, bare_head, read_head
from usmbench.watch.tail import RowTail
from usmbench.watch.trace import Trace

Array = NDArray[np.float64]

SHOWN_WINDOW_COLUMNS: Final = (
    "t_s",
    "phase_deg",
    "speed_rad_s",
    "frequency_hz",
    "torque_nm",
    "angle_rad",
    "sweep",
    "settled",
    "drive_on",
    "temperature_c",
)
SHOWN_PAIR_COLUMNS: Final = ("phase_deg", "speed_rad_s", "direction", "frequency_hz", "torque_nm")
# A window comes every 10 ms; silence this long is more than a busy disk.
SILENT_AFTER_S: Final = 2.0
WHOLE_BUCKETS, RECENT_BUCKETS, RECENT_STRIDE = 600, 500, 4
_PACE_S: Final = 5.0


class LiveView:
    """A run as it is measured, or as it was.

    Parameters
    ----------
    path
        Run folder, or a bare CSV file.
    model
        The simulation to show beside it, or None.
    clock
        Seconds since the epoch, as files are stamped with.

    Raises
    ------
    usmbench.errors.InputError
        No such run, or the model does not fit its windows.
    """

    def __init__(
        self,
        path: Path,
        model: HammersteinModel | None = None,
        clock: Callable[[], float] = time.time,
    ):
        self.path = path
        self._clock = clock
        self._is_folder = path.is_dir()
        self._head_stamp: tuple[int, int] | None = None
        self.head = self._read_head()
        needed = (
            ("t_s", "phase_deg", "speed_rad_s") if self._is_folder else SHOWN_WINDOW_COLUMNS[1:3]
        )
        windows = path / WINDOWS_FILE if self._is_folder else path
        self._windows = RowTail(windows, SHOWN_WINDOW_COLUMNS, needed)
        self._pairs = RowTail(path / PAIRS_FILE, SHOWN_PAIR_COLUMNS, SHOWN_PAIR_COLUMNS)
        self._curve = PairCurve()
        self._beside: SimulationBeside | None = None
        if model is not None:
            self._beside = SimulationBeside(model, self.head.window_s, self.head.name)
        self._model_curve = Curve()
        self._curve_point: tuple[float, ...] = ()
        self._whole = Trace(WHOLE_BUCKETS, 1, whole=True)
        self._recent = Trace(RECENT_BUCKETS, RECENT_STRIDE, whole=False)
        self._last: dict[str, float] = {}
        self._n_windows = 0
        self._paused_s = 0.0
        self._squares = 0.0
        self._n_compared = 0
        self._pace: deque[tuple[float, int]] = deque()
        if not self._is_folder:
            self._take_pairs_of_file()

    def _read_head(self) -> RunHead:
        """Read run.yaml where it has changed."""
        if not self._is_folder:
            return bare_head(self.path)
        try:
            status = (self.path / RUN_FILE).stat()
            stamp = (status.st_mtime_ns, status.st_ino)
        except OSError:
            stamp = None
        if stamp is None or stamp != self._head_stamp:
            self.head = read_head(self.path)
            self._head_stamp = stamp
        return self.head

    def _take_pairs_of_file(self) -> None:
        """Derive the pairs of a bare CSV, which does not grow."""
        pairs = read_run(self.path).pairs
        if pairs is not None:
            columns = [getattr(pairs, name) for name in SHOWN_PAIR_COLUMNS]
            self._curve.add(np.column_stack(columns))

    def look(self) -> None:
        """Take what has come since the last look.

        Raises
        ------
        usmbench.errors.InputError
            The run cannot be read any more.
        """
        self._read_head()
        while len(rows := self._windows.look()):
            self._take(rows)
        if self._is_folder:
            while len(pairs := self._pairs.look()):
                self._curve.add(pairs)
        now_s = self._clock()
        self._pace.append((now_s, self._n_windows))
        while self._pace[0][0] < now_s - _PACE_S:
            self._pace.popleft()

    def _take(self, rows: Array) -> None:
        columns = dict(zip(SHOWN_WINDOW_COLUMNS, rows.T, strict=True))
        if np.isnan(columns["t_s"]).any():
            first = self._n_windows + 1
            columns["t_s"] = self.head.window_s * np.arange(first, first + len(rows))
        simulated_rad_s = self._simulated(columns)
        compared = np.isfinite(simulated_rad_s)
        residual_rad_s = (columns["speed_rad_s"] - simulated_rad_s)[compared]
        self._squares += float(residual_rad_s @ residual_rad_s)
        self._n_compared += int(compared.sum())
        shown_s = self._shown_s(columns["t_s"])
        for trace in (self._whole, self._recent):
            trace.add(shown_s, columns["speed_rad_s"], simulated_rad_s)
        self._n_windows += len(rows)
        self._last = {name: float(column[-1]) for name, column in columns.items()}
        self._last["simulated_rad_s"] = float(simulated_rad_s[-1])

    def _shown_s(self, t_s: Array) -> Array:
        """Return the time of the next rows without the pauses before and among them."""
        before_s = self._last.get("t_s", t_s[0] - self.head.window_s)
        shown_s = without_pauses_s(np.r_[before_s, t_s], self.head.window_s)[1:] - self._paused_s
        self._paused_s = float(t_s[-1] - shown_s[-1])
        return np.asarray(shown_s)

    def _simulated(self, columns: Mapping[str, Array]) -> Array:
        """Return the simulated speeds; have the curve at the operating point of the last row."""
        if self._beside is None:
            return np.full(len(columns["t_s"]), np.nan)
        point = tuple(float(columns[name][-1]) for name in ("frequency_hz", "torque_nm"))
        if not np.array_equal(point, self._curve_point, equal_nan=True):
            self._model_curve = self._beside.curve(*point)
            self._curve_point = point
        return self._beside.simulate(
            Rows(**{part.name: columns[part.name] for part in fields(Rows)})
        )

    def snapshot(self, span: str = "whole") -> dict[str, Any]:
        """Return what the page shows, ready for JSON.

        Parameters
        ----------
        span
            "whole" or "recent": which part of the run the traces cover.
        """
        trace = self._recent if span == "recent" else self._whole
        model = None
        if self._beside is not None:
            model = {
                "phase_deg": _plain(self._model_curve.phase_deg),
                "speed_rad_s": _plain(self._model_curve.speed_rad_s),
                "band_rad_s": self._model_curve.band_rad_s,
                "rmse_rad_s": self._rmse_rad_s(),
            }
        return {
            "name": self.head.name,
            "run": dict(self.head.words),
            "state": self._state(),
            "windows": self._n_windows,
            "planned_windows": self.head.planned_windows,
            "left_s": self._left_s(),
            "windows_per_s": self._windows_per_s(),
            "silent_s": self._silent_s(),
            "unreadable_rows": self._windows.unreadable_rows,
            "now": {name: _number(value) for name, value in self._last.items()},
            "curve": self._curve.columns(),
            "model": model,
            "trace": {name: _plain(column) for name, column in trace.columns().items()},
        }

    def _rmse_rad_s(self) -> float | None:
        return (self._squares / self._n_compared) ** 0.5 if self._n_compared else None

    def _state(self) -> dict[str, Any]:
        """Say how the run stands, and whether it can be stopped."""
        head, silent_s = self.head, self._silent_s()
        stop_asked_s = self._stop_asked_s()
        if head.outcome is not None:
            word, says = head.outcome.partition(":")[0], head.outcome
        elif stop_asked_s is not None:
            word = "stopping"
            says = "stop requested; the sweep takes it with its next windows"
            if stop_asked_s > SILENT_AFTER_S:
                says = "the stop request is not taken: cut the power of the amplifiers"
        elif silent_s is None or silent_s <= SILENT_AFTER_S:
            word, says = "measuring", "rows are coming in"
        else:
            word = "silent"
            says = f"no row for {silent_s:.0f} s: the measuring process waits or has died"
        return {"word": word, "says": says, "can_be_stopped": head.can_be_stopped}

    def _stop_asked_s(self) -> float | None:
        """Return how long a stop request has been lying there, None without one."""
        try:
            return self._clock() - (self.path / STOP_FILE).stat().st_mtime
        except OSError:
            return None

    def _silent_s(self) -> float | None:
        """Return the time since the last row, None for a run that is over."""
        if self.head.outcome is not None:
            return None
        try:
            return max(self._clock() - self._windows.path.stat().st_mtime, 0.0)
        except OSError as error:
            message = f"has gone: {error.strerror}; start `usmbench watch` anew"
            raise InputError(message, file=self._windows.path) from error

    def _windows_per_s(self) -> float | None:
        """Return the pace over the last seconds, None where nothing moves."""
        if len(self._pace) < 2 or self.head.outcome is not None:
            return None
        (begun_s, before), (now_s, now) = self._pace[0], self._pace[-1]
        return (now - before) / (now_s - begun_s) if now_s > begun_s else None

    def _left_s(self) -> float | None:
        pace, planned = self._windows_per_s(), self.head.planned_windows
        if not pace or planned is None:
            return None
        return max(planned - self._n_windows, 0) / pace


def _plain(column: Array) -> list[float | None]:
    """Return numbers as JSON has them: short, and null where there is none."""
    return [None if value != value else value for value in np.round(column, 4).tolist()]


def _number(value: float) -> float | None:
    return None if value != value else value
