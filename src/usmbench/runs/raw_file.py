"""raw.h5 as HDF5 leaves it: continued after a kill, cut to what was written, closed or let be."""

import ctypes
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import h5py
import numpy as np

UNWRITTEN: Final = int(np.iinfo(np.int64).min)
"""Fill value of what no sample can be, so that it shows where a write did not get through."""

_BLOCK_COLUMNS: Final = ("first_sample", "block_samples")


def recover(path: Path) -> None:
    """Copy what a killed writer left into a file that can be continued.

    Parameters
    ----------
    path
        The file; one that was closed stays as it is.
    """
    try:
        h5py.File(path, "r+", libver="latest").close()
    except OSError:
        new = path.with_name(path.name + ".new")
        new.unlink(missing_ok=True)
        try:
            _copy(path, new)
            new.replace(path)
        finally:
            new.unlink(missing_ok=True)


def _copy(path: Path, new: Path) -> None:
    with h5py.File(path, "r", libver="latest", swmr=True) as old:
        copy = h5py.File(new, "x", libver="latest")
        try:
            for name in old:
                old.copy(name, copy)
        finally:
            close(copy, {})


def close(file: Any, columns: Mapping[str, Any]) -> None:
    """Close a file, or let it be where HDF5 cannot write what it still holds.

    Parameters
    ----------
    file
        The open file.
    columns
        Every open dataset of it.

    Raises
    ------
    OSError, RuntimeError
        HDF5 cannot write; on disk the file is as a kill leaves it.
    """
    try:
        file.flush()
    except (OSError, RuntimeError):
        # After a close that fails the process crashes as it ends (h5py issues 914, 2160). A flush
        # may fail, but then nothing must close the file or a dataset, not even the interpreter.
        for opened in (file, *columns.values()):
            ctypes.pythonapi.Py_IncRef(ctypes.py_object(opened.id))
        raise
    file.close()


def drop_unwritten(columns: Mapping[str, Any]) -> None:
    """Cut off the blocks that were not written whole, of a write that failed or was killed.

    Parameters
    ----------
    columns
        The file's datasets, by name.
    """
    written = {name: _written(column) for name, column in columns.items()}
    ends = np.cumsum(columns["block_samples"][: min(written[name] for name in _BLOCK_COLUMNS)])
    n_blocks = int(np.searchsorted(ends, written["counts"], side="right"))
    n_samples = int(ends[n_blocks - 1]) if n_blocks else 0
    for name, column in columns.items():
        length = min(written[name], n_blocks if name in _BLOCK_COLUMNS else n_samples)
        if len(column) > length:
            column.resize(length, axis=0)


def _written(column: Any) -> int:
    """Return how many values there are before the first that was not written."""
    step = column.chunks[0]
    for first in range(0, len(column), step):
        try:
            missing = np.flatnonzero(column[first : first + step] == UNWRITTEN)
        except OSError:  # a chunk that was torn
            return first
        if missing.size:
            return first + int(missing[0])
    return len(column)
