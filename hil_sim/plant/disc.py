"""The encoder disc: quadrature count and index pulse from the exact angle at each sample."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from hil_sim.plant.parameters import DiscParameters
from hil_sim.plant.rotor import Piece, RotorState, is_rest

Channel = Literal["a", "b"]
DiscError = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Angle by which the sensor sees the pattern ahead of the shaft, at the shaft's angles (rad)."""


@dataclass(frozen=True, slots=True)
class _StuckChannel:
    """What the X4 decoder shows while one channel is stuck: the other one's level, up or down."""

    live: Channel
    stuck_level: int
    base: int

    @property
    def sign(self) -> int:
        """Count on the live channel's rising edge: 00 → 10 and 10 → 11 count up."""
        return 1 if (self.live == "b") == bool(self.stuck_level) else -1

    def code(self, true: int) -> int:
        """Position in the cycle 00, 10, 11, 01 of the levels that the decoder sees."""
        live = _level(true, self.live)
        a, b = (self.stuck_level, live) if self.live == "b" else (live, self.stuck_level)
        return (a ^ b) + 2 * b


class Disc:
    """Code wheel on the shaft, with its sensor and X4 decoder.

    Parameters
    ----------
    parameters
        Lines, start position, place of the index.
    error
        How the pattern departs from the shaft's angle; periodic in a turn. None where it does not.
    """

    def __init__(self, parameters: DiscParameters, error: DiscError | None = None):
        self._error = error
        self._counts_per_rev = 4 * parameters.lines
        self._counts_per_rad = self._counts_per_rev / (2.0 * np.pi)
        self._offset = parameters.start_offset_counts
        self._index_count = parameters.index_count % self._counts_per_rev
        self._slip = (0, 0.0)
        self._standing: tuple[int, float] | None = None
        self._stuck: _StuckChannel | None = None
        self._shift = 0
        self._pulses = 0
        self._turn = -1 if self._index_count > 0 else 0

    def set_coupling(self, coupled: bool, shaft: RotorState) -> None:
        """Couple the disc to the shaft, or let it stand where it is.

        Parameters
        ----------
        coupled
            Whether the disc turns with the shaft.
        shaft
            The shaft now.
        """
        if coupled and self._standing is not None:
            revolutions, angle_rad = self._standing
            self._slip = (shaft.revolutions - revolutions, shaft.angle_rad - angle_rad)
            self._standing = None
        elif not coupled and self._standing is None:
            self._standing = self._place(shaft)

    def set_dead_channel(self, channel: Channel | None, shaft: RotorState) -> None:
        """Let a channel stick at its present level, or mend it.

        Parameters
        ----------
        channel
            The channel that sticks, None where both work.
        shaft
            The shaft now.
        """
        true = self._true_count(shaft)
        if self._stuck is not None:
            # The mended channel jumps to its level, which the decoder counts.
            jump = (true - self._stuck.code(true) + 1) % 4 - 1
            shown = self._stuck.base + self._stuck.sign * _level(true, self._stuck.live)
            self._shift = shown + jump - true
            self._stuck = None
        if channel is not None:
            live: Channel = "b" if channel == "a" else "a"
            stuck = _StuckChannel(live, _level(true, channel), 0)
            base = true + self._shift - stuck.sign * _level(true, live)
            self._stuck = _StuckChannel(live, stuck.stuck_level, base)

    def read(
        self, times_s: NDArray[np.float64], path: Sequence[Piece]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return count and index pulses at the given times.

        Parameters
        ----------
        times_s
            Rising times within the path, shape (N,).
        path
            The shaft's path; each piece holds until the next one starts.

        Returns
        -------
        tuple of ndarray
            X4 count and number of index pulses since the start, shape (N,) each.
        """
        true = self._true_counts(times_s, path)
        pulses = self._index_pulses(true)
        if self._stuck is None:
            return (true if self._shift == 0 else true + self._shift), pulses
        return self._stuck.base + self._stuck.sign * _level(true, self._stuck.live), pulses

    def _place(self, shaft: RotorState) -> tuple[int, float]:
        """Whole turns and angle of the disc."""
        if self._standing is not None:
            return self._standing
        revolutions, angle_rad = self._slip
        return shaft.revolutions - revolutions, shaft.angle_rad - angle_rad

    def _true_count(self, shaft: RotorState) -> int:
        revolutions, angle_rad = self._place(shaft)
        fraction = angle_rad * self._counts_per_rad + self._offset
        if self._error is not None:
            fraction += float(self._error(np.array([angle_rad]))[0]) * self._counts_per_rad
        return revolutions * self._counts_per_rev + int(np.floor(fraction))

    def _true_counts(
        self, times_s: NDArray[np.float64], path: Sequence[Piece]
    ) -> NDArray[np.int64]:
        """Count at each time with both channels working."""
        last = path[-1]
        if self._standing is not None or (last[0] <= times_s[0] and is_rest(last)):
            shaft = RotorState(0.0, last[1], last[2])
            return np.full(times_s.size, self._true_count(shaft), dtype=np.int64)
        # Columns as in a piece; turns stay apart, so that precision never fades.
        per_rad = self._counts_per_rad
        pieces = np.array(path)
        pieces -= (0.0, self._slip[0], self._slip[1], 0.0, 0.0, 0.0)
        pieces *= (1.0, self._counts_per_rev, per_rad, per_rad, per_rad, per_rad)
        pieces += (0.0, 0.0, self._offset, 0.0, 0.0, 0.0)
        ends = times_s.searchsorted(pieces[:, 0])
        ends[:-1] = ends[1:]
        ends[-1] = times_s.size
        ends[1:] -= ends[:-1].copy()
        start_s, turns, c_0, c_1, c_2, c_3 = pieces.T.repeat(ends, axis=1)
        since_s = times_s - start_s
        # Horner's scheme element by element: the same bits however the samples are split.
        c_3 *= since_s
        c_3 += c_2
        c_3 *= since_s
        c_3 += c_1
        c_3 *= since_s
        c_3 += c_0
        if self._error is not None:
            angle_rad = (c_3 - self._offset) / self._counts_per_rad
            c_3 += self._error(angle_rad) * self._counts_per_rad
        np.floor(c_3, out=c_3)
        c_3 += turns
        counts: NDArray[np.int64] = c_3.astype(np.int64)
        return counts

    def _index_pulses(self, true: NDArray[np.int64]) -> NDArray[np.int64]:
        """Crossings of the index line, in either direction, up to each sample."""
        low = (int(np.minimum.reduce(true)) - self._index_count) // self._counts_per_rev
        high = (int(np.maximum.reduce(true)) - self._index_count) // self._counts_per_rev
        if low == high == self._turn:
            return np.full(true.size, self._pulses, dtype=np.int64)
        turns = (true - self._index_count) // self._counts_per_rev
        pulses = self._pulses + np.cumsum(np.abs(np.diff(turns, prepend=self._turn)))
        self._turn, self._pulses = int(turns[-1]), int(pulses[-1])
        return pulses


_Count = TypeVar("_Count", int, NDArray[np.int64])


def _level(count: _Count, channel: Channel) -> _Count:
    """Level of a channel at a count: A leads B by a quarter of a line."""
    return ((count + 1 if channel == "a" else count) >> 1) & 1
