"""Vectors of MATLAB files, of any version."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import h5py
import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat

from usmbench.errors import InputError
from usmbench.runs.record import Column

_HDF5_SIGNATURE: Final = b"\x89HDF\r\n\x1a\n"
# MATLAB 7.3 puts its own header before HDF5's signature.
_MAT73_OFFSET: Final = 512
_MAX_VALUES: Final = 500_000_000


class MatFile:
    """The vectors of a MATLAB file; those in a struct have its name before theirs, with a dot.

    Parameters
    ----------
    path
        The file, of any version.

    Raises
    ------
    usmbench.errors.InputError
        It is no such file.
    OSError
        It cannot be read.
    """

    def __init__(self, path: Path):
        self._path = path
        with path.open("rb") as file:
            head = file.read(_MAT73_OFFSET + len(_HDF5_SIGNATURE))
        is_hdf5 = head.startswith(_HDF5_SIGNATURE) or head.endswith(_HDF5_SIGNATURE)
        try:
            found = _hdf5_vectors(path) if is_hdf5 else loadmat(path, simplify_cells=True)
            self._vectors = dict(_vectors(found, ""))
        except Exception as error:
            # A broken file makes SciPy raise almost anything.
            message = f"is no MATLAB file that can be read ({type(error).__name__}); save it again"
            raise InputError(message, file=path) from error

    @property
    def names(self) -> list[str]:
        """Names of the vectors."""
        return list(self._vectors)

    def column(self, name: str) -> Column:
        """Return a vector.

        Parameters
        ----------
        name
            One of `names`.
        """
        return self._vectors[name]

    def error(self, row: int, message: str) -> InputError:
        """Return the error that points at an entry.

        Parameters
        ----------
        row
            The entry, from 0.
        message
            What is wrong there.
        """
        return InputError(f"entry {row + 1}: {message}", file=self._path)


def _vectors(found: dict[str, Any], before: str) -> Iterator[tuple[str, Column]]:
    """Yield what is a vector of numbers, in structs too."""
    for name, value in found.items():
        if isinstance(value, dict):
            yield from _vectors(value, f"{before}{name}.")
        elif isinstance(value, np.ndarray) and _is_vector(value):
            yield before + name, value.reshape(-1).astype(np.float64)


def _is_vector(value: NDArray[Any]) -> bool:
    return value.dtype.kind in "biuf" and value.size > 1 and value.size == max(value.shape)


def _hdf5_vectors(path: Path) -> dict[str, Any]:
    """Return the vectors of a file in version 7.3, by their paths with dots."""
    found: dict[str, Any] = {}

    def take(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "biuf":
            if item.size > _MAX_VALUES:
                raise ValueError(name)
            if item.size > 1 and item.size == max(item.shape):
                found[name.replace("/", ".")] = item[()]

    with h5py.File(path, "r") as file:
        file.visititems(take)
    return found
