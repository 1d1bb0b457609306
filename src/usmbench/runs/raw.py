"""The counter samples themselves, in HDF5."""

import os
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from usmbench.errors import BenchError
from usmbench.instruments.samples import SampleBlock

_CHUNK_SAMPLES = 65536
_CHUNK_BLOCKS = 1024
_NOT_READ = -1


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
        try:
            if path.exists():
                _recover(path)
            self._file = h5py.File(path, "a", libver="latest")
            self._columns = {name: self._column(name) for name in _CHUNKS}
            self._file.swmr_mode = True
        except (OSError, RuntimeError, KeyError, ValueError) as error:
            raise _raw_error(path, error) from error

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
            fillvalue=_NOT_READ,
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
        except (OSError, RuntimeError) as error:
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
        except (OSError, RuntimeError) as error:
            raise _raw_error(self.path, error) from error

    def close(self) -> None:
        """Close the file.

        Raises
        ------
        usmbench.errors.BenchError
            HDF5 could not write what it still held.
        """
        try:
            self._file.close()
        except (OSError, RuntimeError) as error:
            raise _raw_error(self.path, error) from error


_CHUNKS = {
    "counts": _CHUNK_SAMPLES,
    "index_counts": _CHUNK_SAMPLES,
    "first_sample": _CHUNK_BLOCKS,
    "block_samples": _CHUNK_BLOCKS,
}


def _recover(path: Path) -> None:
    """Copy what a killed writer left into a file that can be continued."""
    try:
        h5py.File(path, "r+", libver="latest").close()
    except OSError:
        new = path.with_name(path.name + ".new")
        with (
            h5py.File(path, "r", libver="latest", swmr=True) as old,
            h5py.File(new, "w", libver="latest") as copy,
        ):
            for name in old:
                old.copy(name, copy)
        new.replace(path)


def _raw_error(path: Path, error: Exception) -> BenchError:
    """Return what the user is told when HDF5 fails."""
    return BenchError(
        f"{path}: the counter samples cannot be kept ({error}); the CSV files are safe, "
        "free some space or sweep without raw samples"
    )
