"""The run folder while a run is measured: every row on disk, whatever happens to the process."""

import shutil
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from usmbench.errors import BenchError, InputError, UsmbenchError
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
from usmbench.runs.data_files import DataFiles
from usmbench.runs.disk_sync import DiskSync
from usmbench.runs.files import AppendedFile, disk_error, sync_folder
from usmbench.runs.meta_writer import begin_meta, close_meta, new_meta, resumed_meta
from usmbench.runs.pauses import resumes_at_s
from usmbench.runs.row_text import pair_text, window_text
from usmbench.runs.stop_point import StopPoint, columns_of, stop_point
from usmbench.runs.stop_request import forget_stop_request
from usmbench.sweep.rows import PairRow, WindowRow

EXISTS = "exists already; name another folder (a sweep that stopped goes on by sweep --resume)"
"""What is said of a folder that is there before a run begins."""
_SYNC_PERIOD_S = 0.9  # at most a second between forced writes, with a margin for one window


class RunWriter:
    """Writes one run folder; made by `create` or `resume`.

    Parameters
    ----------
    folder
        The run folder, which exists.
    meta
        What run.yaml says.
    files
        Its open data files.
    """

    def __init__(self, folder: Path, meta: dict[str, Any], files: DataFiles):
        self.folder = folder
        self.stopped_at = StopPoint()
        self._meta = meta
        self._failure: BenchError | None = None
        self._closed = False
        self._files = files
        self._disk = DiskSync(self._files.sync, folder)
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
            raise InputError(EXISTS, file=folder) from None
        except OSError as error:
            raise InputError(
                f"cannot be made: {error.strerror}; name another folder", file=folder
            ) from error
        try:
            return cls._begin(folder, new_meta(meta), temperature=temperature, raw=raw)
        except (OSError, BenchError) as error:
            shutil.rmtree(folder, ignore_errors=True)
            why = error.strerror if isinstance(error, OSError) else str(error).partition(";")[0]
            raise InputError(
                f"cannot be written: {why}; free some space or name another folder", file=folder
            ) from error

    @classmethod
    def _begin(cls, folder: Path, meta: dict[str, Any], *, temperature: bool, raw: bool) -> Self:
        """Write run.yaml and the head of every file."""
        begin_meta(folder, meta)
        writer = cls(folder, meta, DataFiles(folder, temperature=temperature, raw=raw))
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
            No such run, one that is complete, one that another program writes, one whose columns
            are not this program's, or whose last rows are damaged.
        usmbench.errors.BenchError
            The folder cannot be written.
        """
        folder = Path(folder)
        resumed_meta(folder)
        columns = columns_of(folder / WINDOWS_FILE, (WINDOW_COLUMNS, WINDOW_COLUMNS_T))
        columns_of(folder / PAIRS_FILE, (PAIR_COLUMNS_WRITTEN,))
        stop_point(folder)
        files = DataFiles(
            folder, temperature=TEMPERATURE_COLUMN in columns, raw=(folder / RAW_FILE).exists()
        )
        try:
            # All of it again: until the run was locked another program may have gone on with it.
            writer = cls(folder, resumed_meta(folder), files)
            writer._take_up()
        except UsmbenchError:
            files.close()
            raise
        return writer

    def _take_up(self) -> None:
        """Find where the run stopped, and say in run.yaml that it goes on."""
        self.stopped_at = stop_point(self.folder)
        try:
            forget_stop_request(self.folder)
            begin_meta(self.folder, self._meta)
        except OSError as error:
            raise disk_error(self.folder / RUN_FILE, error) from error

    def resumes_at_s(self, least_s: float) -> float:
        """Return the time at which the rows of a run that was taken up go on.

        Parameters
        ----------
        least_s
            The shortest pause since the last of them.
        """
        return resumes_at_s(self.stopped_at.t_s, self._meta, least_s)

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
        self._append(self._files.windows, window_text(row, temperature=self._files.temperature))
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
        self._append(self._files.pairs, pair_text(row))
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
        if self._files.raw is not None:
            try:
                self._files.raw.append(block)
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
        failure = self._close_files()
        told = f"failed: {failure}" if failure and not outcome.startswith("failed") else outcome
        try:
            # While the disk stands still, run.yaml would stand still with it.
            if not self._disk.at_work:
                close_meta(self.folder, self._meta, told, self._files.closed, extra)
        except BenchError as error:
            failure = failure or error
        if failure is not None and not outcome.startswith("failed"):
            raise failure

    def _close_files(self) -> BenchError | None:
        """Force the rows to disk and release the files; return what went wrong first."""
        failure = None
        for step in (self._disk.finish, self._files.close):
            try:
                step()
            except BenchError as error:
                failure = failure or error
            if self._disk.at_work:
                break
        return failure

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
