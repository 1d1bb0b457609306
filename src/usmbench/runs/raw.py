"""The counter samples themselves, in HDF5."""

import os
import re
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from usmbench.errors import BenchError
from usmbench.instruments.samples import SampleBlock
from usmbench.runs.files import new_file
from usmbench.runs.raw_file import UNWRITTEN, close, drop_unwritten, recover

_CHUNK_SAMPLES = 65536
_CHUNK_BLOCKS = 1024
# Of each column at most; so much at least HDF5 may still have to write when a disk is full.
_CACHE_BYTES = 1 << 20
_NOT_READ = -1
# Given back before the file is closed, so that what HDF5 still holds fits on a full disk.
_RESERVE_FILE = ".reserve-raw"
_RESERVE_BYTES = 1 << 18
_HDF5_ERRORS = (OSError, RuntimeError, KeyError, ValueError)


class RawWriter:
    """Appends blocks to raw.h5.

    The file holds `counts`, shape (samples,), `first_sample` and `block_samples`, shape (blocks,),
    and, where the card has an index, `index_counts`: sample by sample beside `counts`, -1 where a
    run ended before the index was read, and as much shorter at the end of the file. It is written
    in HDF5's single-writer mode: after a kill it opens with ``swmr=True`` and holds everything up
    to the last `sync`.

    Parameters
    ----------
    path
        The file. One that exists is continued.

    Raises
    ------
    usmbench.errors.BenchError
        The file cannot be made or continued.
    """

    def __init__(self, path: Path):
        self.path = path
        self._failed = False
        self._reserve = path.with_name(_RESERVE_FILE)
        self._columns: dict[str, Any] = {}
        try:
            if path.exists():
                recover(path)
            with new_file(self._reserve) as file:
                file.write(bytes(_RESERVE_BYTES))
            self._open()
        except _HDF5_ERRORS as error:
            self._reserve.unlink(missing_ok=True)
            raise _raw_error(path, error) from error

    def _open(self) -> None:
        """Open the file, with every column and nothing in it that was not written."""
        self._file = h5py.File(self.path, "a", libver="latest", rdcc_nbytes=_CACHE_BYTES)
        try:
            self._columns = {name: self._column(name) for name in _CHUNKS}
            drop_unwritten(self._columns)
            self._file.swmr_mode = True
        except _HDF5_ERRORS:
            self._release()
            raise

    def _column(self, name: str) -> Any:
        """Return one growing column, made where the file does not have it."""
        if name in self._file:
            return self._file[name]
        return self._file.create_dataset(
            name,
            shape=(0,),
            maxshape=(None,),
            dtype=np.int64,
            chunks=(_CHUNKS[name],),
            fillvalue=_NOT_READ if name == "index_counts" else UNWRITTEN,
            compression="gzip",
            compression_opts=1,
            shuffle=True,
        )

    def append(self, block: SampleBlock) -> None:
        """Append one block.

        Parameters
        ----------
        block
            The samples.

        Raises
        ------
        usmbench.errors.BenchError
            HDF5 could not write.
        """
        columns = {
            "counts": block.counts,
            "first_sample": np.array([block.first_sample]),
            "block_samples": np.array([len(block.counts)]),
        }
        try:
            for name, values in columns.items():
                self._extend(name, self._columns[name].shape[0], values)
            if block.index_counts is not None and len(block.index_counts):
                end = self._columns["counts"].shape[0]
                self._extend("index_counts", end - len(block.index_counts), block.index_counts)
        except _HDF5_ERRORS as error:
            self._failed = True
            raise _raw_error(self.path, error) from error

    def _extend(self, name: str, first: int, values: NDArray[np.int64]) -> None:
        """Let a column end with these values, from its row `first` on."""
        column = self._columns[name]
        column.resize(first + len(values), axis=0)
        column[first:] = values

    def sync(self) -> None:
        """Force what was appended to disk.

        Raises
        ------
        usmbench.errors.BenchError
            HDF5 or the system could not.
        """
        try:
            self._file.flush()
            descriptor = os.open(self.path, os.O_RDWR)
            try:
                os.fsync(descriptor)
            finally:
                os.close(descriptor)
        except _HDF5_ERRORS as error:
            self._failed = True
            raise _raw_error(self.path, error) from error

    def close(self) -> None:
        """Close the file; after a failure it ends with the last block that was written whole.

        Raises
        ------
        usmbench.errors.BenchError
            HDF5 could not write what it still held. The file is then left as a kill leaves it.
        """
        try:
            self._release()
            if self._failed:
                # Of what failed HDF5 takes some for written: only the file itself shows what is.
                self._columns.clear()
                self._open()
                self._release()
        except _HDF5_ERRORS as error:
            raise _raw_error(self.path, error) from error

    def _release(self) -> None:
        """Give the reserve back, and close the file."""
        self._reserve.unlink(missing_ok=True)
        close(self._file, self._columns)


_CHUNKS = {
    "counts": _CHUNK_SAMPLES,
    "index_counts": _CHUNK_SAMPLES,
    "first_sample": _CHUNK_BLOCKS,
    "block_samples": _CHUNK_BLOCKS,
}


def _raw_error(path: Path, error: Exception) -> BenchError:
    """Return what the user is told when HDF5 fails."""
    said = re.search("error message = '([^']*)'", str(error))
    why = said[1] if said else (getattr(error, "strerror", None) or str(error)).partition("\n")[0]
    return BenchError(
        f"{path}: the counter samples cannot be kept ({why}); the CSV files are safe, "
        f"free some space and take the plan up again with --resume {path.parent}, or sweep without "
        "raw samples"
    )
