"""Rows over time in bounded memory: lowest, highest and mean of as many windows as are needed."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_NUMBER = "t_s", "speed_rad_s", "simulated_rad_s"
# End of the bucket; lowest, highest and mean speed; mean simulation; lowest and highest residual.
BUCKET = (
    "t_s",
    "low_rad_s",
    "high_rad_s",
    "mean_rad_s",
    "simulated_rad_s",
    "residual_low_rad_s",
    "residual_high_rad_s",
)


class Trace:
    """Speed, simulation and residual over time.

    Parameters
    ----------
    capacity
        Buckets that are kept, an even number.
    stride
        Windows in a bucket.
    whole
        True keeps the whole run: when the buckets run out, pairs of them are joined. False keeps
        the latest.
    """

    def __init__(self, capacity: int, stride: int, *, whole: bool):
        self._capacity = capacity
        self._stride = stride
        self._whole = whole
        self._pending = np.empty((0, len(_NUMBER)))
        self._buckets = np.empty((0, len(BUCKET)))

    def add(self, t_s: Array, speed_rad_s: Array, simulated_rad_s: Array) -> None:
        """Take windows.

        Parameters
        ----------
        t_s
            End of each window, shape (n,).
        speed_rad_s
            Measured speed, shape (n,).
        simulated_rad_s
            Simulated speed, shape (n,); NaN where there is none.
        """
        rows = np.column_stack([t_s, speed_rad_s, simulated_rad_s])
        self._pending = np.concatenate([self._pending, rows])
        while len(self._pending) >= self._stride:
            room = self._capacity - len(self._buckets) if self._whole else self._capacity
            n_buckets = min(len(self._pending) // self._stride, room)
            n_rows = n_buckets * self._stride
            taken, self._pending = self._pending[:n_rows], self._pending[n_rows:]
            new = _bucketed(taken.reshape(n_buckets, self._stride, len(_NUMBER)))
            self._buckets = np.concatenate([self._buckets, new])
            self._make_room()

    def _make_room(self) -> None:
        if not self._whole:
            self._buckets = self._buckets[-self._capacity :]
        elif len(self._buckets) >= self._capacity:
            pairs = self._buckets.reshape(-1, 2, len(BUCKET))
            self._buckets = _joined(pairs)
            self._stride *= 2

    def columns(self) -> dict[str, Array]:
        """Return the buckets by column name, shape (buckets,) each; see `BUCKET`."""
        return dict(zip(BUCKET, self._buckets.T, strict=True))


def _bucketed(rows: Array) -> Array:
    """Return the buckets of rows of shape (buckets, windows, 3)."""
    speed_rad_s, simulated_rad_s = rows[..., 1], rows[..., 2]
    residual_rad_s = speed_rad_s - simulated_rad_s
    columns = [
        rows[:, -1, 0],
        speed_rad_s.min(axis=1),
        speed_rad_s.max(axis=1),
        speed_rad_s.mean(axis=1),
        simulated_rad_s.mean(axis=1),
        residual_rad_s.min(axis=1),
        residual_rad_s.max(axis=1),
    ]
    return np.column_stack(columns)


def _joined(pairs: Array) -> Array:
    """Return one bucket for each pair of shape (2, 7)."""
    joined: Array = pairs.mean(axis=1)
    for place, name in enumerate(BUCKET):
        if name == "t_s":
            joined[:, place] = pairs[:, 1, place]
        elif "low" in name:
            joined[:, place] = pairs[..., place].min(axis=1)
        elif "high" in name:
            joined[:, place] = pairs[..., place].max(axis=1)
    return joined
