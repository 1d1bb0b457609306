"""The run folder while a run is measured: every row on disk, whatever happens to the process.

Numbers are written with 12 significant digits (a relative error of at most 5e-12): a day of time
stamps to the microsecond, a day of angle at full speed to the microradian.
"""

import secrets
import shutil
import time
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from typing import Any, Self

import yaml

from usmbench import __version__
from usmbench.errors import BenchError, InputError
from usmbench.instruments.samples import SampleBlock
from usmbench.runs.columns import (
    FORMAT,
    PAIR_COLUMNS_WRITTEN,
    PAIRS_FILE,
    RAW_FILE,
    RUN_FILE,
    TEMPERATURE_COLUMN,
    WINDOW_COLUMNS,
    WINDOW_COLUMNS_T,
    WINDOWS_FILE,
)
from usmbench.runs.disk_sync import DiskSync
from usmbench.runs.files import AppendedFile, disk_error, replace_file, sync_folder
from usmbench.runs.meta import now_iso, read_meta, sha256_of
from usmbench.runs.raw import RawWriter
from usmbench.runs.stop_point import StopPoint, columns_of, stop_point
from usmbench.runs.stop_request import forget_stop_request
from usmbench.sweep.rows import PairRow, WindowRow

# At most a second between forced writes, with a margin for one window.
_SYNC_PERIOD_S = 0.9
# Given back before run.yaml is closed, so that a full disk can still be told about.
_RESERVE_FILE = ".reserve"
_RESERVE_BYTES = 65536


class RunWriter:
    """Writes one run folder; made by `create` or `resume`.

    Parameters
    ----------
    folder
        The run folder, which exists.
    meta
        What run.yaml says.
    temperature
        Whether windows.csv has the temperature column.
    raw
        Whether raw.h5 is kept.
    """

    def __init__(self, folder: Path, meta: dict[str, Any], *, temperature: bool, raw: bool):
        self.folder = folder
        self.stopped_at = StopPoint()
        self._meta = meta
        self._temperature = temperature
        self._failure: BenchError | None = None
        self._closed = False
        self._windows = AppendedFile(folder / WINDOWS_FILE)
        self._pairs = AppendedFile(folder / PAIRS_FILE)
        self._raw = RawWriter(folder / RAW_FILE) if raw else None
        self._disk = DiskSync(self._sync, folder)
        self._synced = time.monotonic()

    @classmethod
    def create(cls, folder: Path, meta: Mapping[str, Any], *, temperature: bool, raw: bool) -> Self:
        """Make a new run folder and write run.yaml.

        Parameters
        ----------
        folder
            The folder to make; its parents are made too.
        meta
            What run.yaml is to say: motor, encoder, plan, bench. The format, an id, the start and
            the software's version are added.
        temperature
            Whether windows.csv gets a temperature column.
        raw
            Whether counter samples are kept in raw.h5.

        Returns
        -------
        RunWriter
            Ready for the first window.

        Raises
        ------
        usmbench.errors.InputError
            The folder exists, or cannot be made or written.
        """
        folder = Path(folder)
        started = datetime.now().astimezone()
        head = {
            "format": FORMAT,
            "id": f"{started:%Y%m%dT%H%M%S}-{secrets.token_hex(4)}",
            "started": started.isoformat(timespec="milliseconds"),
            "software": f"usmbench {__version__}",
        }
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            raise InputError(
                "exists already; name another folder, or continue it with --resume", file=folder
            ) from None
        except OSError as error:
            raise InputError(
                f"cannot be made: {error.strerror}; name another folder", file=folder
            ) from error
        try:
            return cls._begin(folder, head | dict(meta), temperature=temperature, raw=raw)
        except (OSError, BenchError) as error:
            shutil.rmtree(folder, ignore_errors=True)
            why = error.strerror if isinstance(error, OSError) else error
            raise InputError(
                f"cannot be written: {why}; free some space or name another folder", file=folder
            ) from error

    @classmethod
    def _begin(cls, folder: Path, meta: dict[str, Any], *, temperature: bool, raw: bool) -> Self:
        """Write run.yaml and the head of every file."""
        replace_file(folder / RUN_FILE, _yaml(meta))
        (folder / _RESERVE_FILE).write_bytes(bytes(_RESERVE_BYTES))
        writer = cls(folder, meta, temperature=temperature, raw=raw)
        writer._write_heads()
        sync_folder(folder)
        sync_folder(folder.parent)
        return writer

    @classmethod
    def resume(cls, folder: Path) -> Self:
        """Take up an interrupted run; `stopped_at` of the writer says where.

        Parameters
        ----------
        folder
            The run folder. Rows that a cut tore are dropped.

        Returns
        -------
        RunWriter
            Ready to append; run.yaml no longer says that the run has stopped.

        Raises
        ------
        usmbench.errors.InputError
            No such run, one that is complete, or one whose columns are not this program's.
        usmbench.errors.BenchError
            The folder cannot be written.
        """
        folder = Path(folder)
        meta = read_meta(folder)
        if meta.get("exit") == "completed":
            raise InputError("the run is complete, there is nothing to resume", file=folder)
        for key in ("exit", "stopped", "sha256"):
            meta.pop(key, None)
        before = meta.get("resumed")
        meta["resumed"] = [*(before if isinstance(before, list) else []), now_iso()]
        columns = columns_of(folder / WINDOWS_FILE, (WINDOW_COLUMNS, WINDOW_COLUMNS_T))
        columns_of(folder / PAIRS_FILE, (PAIR_COLUMNS_WRITTEN,))
        try:
            forget_stop_request(folder)
            replace_file(folder / RUN_FILE, _yaml(meta))
            (folder / _RESERVE_FILE).write_bytes(bytes(_RESERVE_BYTES))
        except OSError as error:
            raise disk_error(folder / RUN_FILE, error) from error
        writer = cls(
            folder,
            meta,
            temperature=TEMPERATURE_COLUMN in columns,
            raw=(folder / RAW_FILE).exists(),
        )
        writer._windows.drop_torn_row()
        writer._pairs.drop_torn_row()
        writer._write_heads()
        writer.stopped_at = stop_point(folder)
        return writer

    def _write_heads(self) -> None:
        """Write the column names into files that have none."""
        columns = WINDOW_COLUMNS_T if self._temperature else WINDOW_COLUMNS
        for file, names in ((self._windows, columns), (self._pairs, PAIR_COLUMNS_WRITTEN)):
            if not file.size:
                file.append((",".join(names) + "\n").encode())
            file.sync()

    def window(self, row: WindowRow) -> None:
        """Append one window; on disk within a second.

        Parameters
        ----------
        row
            The window; its temperature is left out where the run has no such column.

        Raises
        ------
        usmbench.errors.BenchError
            The row could not be written, or the disk has not taken those before it.
        """
        text = (
            f"{row.t_s:.12g},{row.phase_deg:.12g},{row.speed_rad_s:.12g},{row.frequency_hz:.12g},"
            f"{row.torque_nm:.12g},{row.angle_rad:.12g},{row.window_s:.12g},{row.sweep:d},"
            f"{row.settled:d},{row.average_rad_s:.12g},{row.drive_on:d}"
        )
        if self._temperature:
            text += ",nan" if row.temperature_c is None else f",{row.temperature_c:.12g}"
        self._append(self._windows, text)
        if time.monotonic() - self._synced >= _SYNC_PERIOD_S:
            self._force()

    def pair(self, row: PairRow) -> None:
        """Append one pair and have everything so far forced to disk, which is not waited for.

        Parameters
        ----------
        row
            The pair of the dwell that has just ended.

        Raises
        ------
        usmbench.errors.BenchError
            The row could not be written, or the disk has not taken those before it.
        """
        self._append(
            self._pairs,
            f"{row.phase_deg:.12g},{row.frequency_hz:.12g},{row.torque_nm:.12g},"
            f"{row.speed_rad_s:.12g},{row.speed_std_rad_s:.12g},{row.n_windows:d},"
            f"{row.direction:d},{row.t_s:.12g},{row.dwell:d},{row.settled:d}",
        )
        self._force()

    def raw(self, block: SampleBlock) -> None:
        """Append a block's samples to raw.h5, where the run keeps it.

        Parameters
        ----------
        block
            The samples.

        Raises
        ------
        usmbench.errors.BenchError
            The samples could not be written.
        """
        if self._raw is not None:
            try:
                self._raw.append(block)
            except BenchError as error:
                self._failure = error
                raise

    def close(self, outcome: str, /, **extra: Any) -> None:
        """Force everything to disk and say in run.yaml how the run ended.

        Parameters
        ----------
        outcome
            "completed", "interrupted" or "failed: reason".
        **extra
            Further keys for run.yaml.

        Raises
        ------
        usmbench.errors.BenchError
            The folder could not be closed. Not raised after a failure, of a write or one that
            `outcome` tells of, which would be hidden by it; the rows are safe in any case.
        """
        if self._closed:
            return
        self._closed = True
        if self._failure is not None and not outcome.startswith("failed"):
            outcome = f"failed: {self._failure}"
        try:
            self._close_files()
            self._close_meta(outcome, extra)
        except BenchError:
            if not outcome.startswith("failed"):
                raise

    def _close_files(self) -> None:
        """Force the rows to disk and release the files."""
        try:
            self._disk.finish()
        finally:
            self._windows.close()
            self._pairs.close()
            if self._raw is not None:
                self._raw.close()

    def _close_meta(self, outcome: str, extra: Mapping[str, Any]) -> None:
        """Say in run.yaml how the run ended."""
        path = self.folder / RUN_FILE
        try:
            (self.folder / _RESERVE_FILE).unlink(missing_ok=True)
            forget_stop_request(self.folder)
            names = [WINDOWS_FILE, PAIRS_FILE] + ([RAW_FILE] if self._raw else [])
            stopped = {"stopped": now_iso(), "exit": outcome, **extra}
            sums = {"sha256": {name: sha256_of(self.folder / name) for name in names}}
            replace_file(path, _yaml(self._meta | stopped | sums))
        except OSError as error:
            raise disk_error(path, error) from error

    def _append(self, file: AppendedFile, row: str) -> None:
        """Append one row and remember a failure for `close`."""
        try:
            self._disk.check()
            file.append((row + "\n").encode())
        except BenchError as error:
            self._failure = error
            raise

    def _force(self) -> None:
        """Have everything forced to disk meanwhile."""
        self._disk.request()
        self._synced = time.monotonic()

    def _sync(self) -> None:
        """Force everything to disk, windows before the pairs that were made from them."""
        self._windows.sync()
        self._pairs.sync()
        if self._raw is not None:
            self._raw.sync()


def _yaml(meta: Mapping[str, Any]) -> bytes:
    """Return run.yaml's text."""
    return yaml.safe_dump(dict(meta), sort_keys=False, allow_unicode=True).encode()
