"""The run folder while a run is measured: every row on disk, whatever happens to the process."""

import shutil
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from usmbench.errors import BenchError, InputError
from usmbench.instruments.samples import SampleBlock
from usmbench.runs.columns import (
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
from usmbench.runs.files import AppendedFile, disk_error, sync_folder
from usmbench.runs.meta_writer import begin_meta, close_meta, new_meta, resumed_meta
from usmbench.runs.pauses import resumes_at_s
from usmbench.runs.raw import RawWriter
from usmbench.runs.row_text import pair_text, window_text
from usmbench.runs.stop_point import StopPoint, columns_of, stop_point
from usmbench.runs.stop_request import forget_stop_request
from usmbench.sweep.rows import PairRow, WindowRow

# At most a second between forced writes, with a margin for one window.
_SYNC_PERIOD_S = 0.9


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
            return cls._begin(folder, new_meta(meta), temperature=temperature, raw=raw)
        except (OSError, BenchError) as error:
            shutil.rmtree(folder, ignore_errors=True)
            why = error.strerror if isinstance(error, OSError) else error
            raise InputError(
                f"cannot be written: {why}; free some space or name another folder", file=folder
            ) from error

    @classmethod
    def _begin(cls, folder: Path, meta: dict[str, Any], *, temperature: bool, raw: bool) -> Self:
        """Write run.yaml and the head of every file."""
        begin_meta(folder, meta)
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
        meta = resumed_meta(folder)
        columns = columns_of(folder / WINDOWS_FILE, (WINDOW_COLUMNS, WINDOW_COLUMNS_T))
        columns_of(folder / PAIRS_FILE, (PAIR_COLUMNS_WRITTEN,))
        try:
            forget_stop_request(folder)
            begin_meta(folder, meta)
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

    def resumes_at_s(self, least_s: float) -> float:
        """Return the time at which the rows of a run that was taken up go on.

        Parameters
        ----------
        least_s
            The shortest pause since the last of them.
        """
        return resumes_at_s(self.stopped_at.t_s, self._meta, least_s)

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
        self._append(self._windows, window_text(row, temperature=self._temperature))
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
        self._append(self._pairs, pair_text(row))
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
            names = [WINDOWS_FILE, PAIRS_FILE] + ([RAW_FILE] if self._raw else [])
            close_meta(self.folder, self._meta, outcome, names, extra)
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
