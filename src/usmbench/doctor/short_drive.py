"""A short drive, one way and back: no longer than the index needs."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from math import copysign
from typing import Final

import numpy as np

from usmbench.errors import BenchError
from usmbench.instruments.samples import SampleBlock, SampleSource
from usmbench.settings.bench import BenchSettings
from usmbench.settings.plan import USUAL_FREQUENCY_HZ
from usmbench.sweep.controller import Instruments, SweepController
from usmbench.sweep.drive import DriveControl
from usmbench.sweep.operator import Operator
from usmbench.sweep.rows import PairRow, WindowRow
from usmbench.sweep.schedule import Dwell

# Slow first, so that an encoder with half the lines does not trip the over-speed interlock; the
# last is where a motor must turn if it turns at all.
PHASES_DEG: Final = (30.0, 60.0, 90.0)
_DWELL_S: Final = 0.25
_LEAST_S: Final = 1.5
_STILL_AFTER_S: Final = 0.75
_LONGEST_S: Final = 12.0
# Two whole revolutions from the first pulse to the third.
_PULSES: Final = 3
NO_MOTION_COUNTS: Final = 4  # of all windows of one direction


@dataclass(slots=True)
class ShortDrive:
    """Everything that a short drive showed; the sink of its sweep.

    Parameters
    ----------
    rows
        The windows.
    blocks
        Their counter samples.
    error
        What stopped the drive early, None where nothing did.
    """

    rows: list[WindowRow] = field(default_factory=list)
    blocks: list[SampleBlock] = field(default_factory=list)
    error: BenchError | None = None

    def window(self, row: WindowRow) -> None:
        """Keep one window.

        Parameters
        ----------
        row
            The window.
        """
        self.rows.append(row)

    def pair(self, row: PairRow) -> None:
        """Take a pair, which a short drive has none of.

        Parameters
        ----------
        row
            The pair.
        """

    def raw(self, block: SampleBlock) -> None:
        """Keep one block's samples.

        Parameters
        ----------
        block
            The samples.
        """
        self.blocks.append(block)

    def driven(self, direction: int) -> "Driven":
        """Return what was seen while driven in one direction.

        Parameters
        ----------
        direction
            +1 for positive phase, -1 for negative.
        """
        chosen = [
            (row, block)
            for row, block in zip(self.rows, self.blocks, strict=False)
            if row.drive_on and row.phase_deg * direction > 0
        ]
        # The second half has left the run-up behind.
        late = [row for row, _ in chosen[len(chosen) // 2 :]]
        return Driven(
            phase_deg=late[-1].phase_deg if late else 0.0,
            speed_rad_s=float(np.mean([row.average_rad_s for row in late])) if late else 0.0,
            travelled_rad=chosen[-1][0].angle_rad - chosen[0][0].angle_rad if chosen else 0.0,
            edges=sum(int(np.count_nonzero(np.diff(block.counts))) for _, block in chosen),
        )

    def pulses(self) -> int:
        """Return the index pulses up to now."""
        for block in reversed(self.blocks):
            if block.index_counts is not None and len(block.index_counts):
                return int(block.index_counts[-1])
        return 0


@dataclass(frozen=True, slots=True)
class Driven:
    """One direction of a short drive.

    Parameters
    ----------
    phase_deg
        Phase at its end; 0 where it was not driven.
    speed_rad_s
        Mean speed over the second half, with the sign of the bench file's encoder.
    travelled_rad
        Angle from its first window to its last.
    edges
        Changes of the counter.
    """

    phase_deg: float
    speed_rad_s: float
    travelled_rad: float
    edges: int


def drive_shortly(
    bench: BenchSettings, drive: DriveControl, source: SampleSource, operator: Operator
) -> ShortDrive:
    """Drive the motor one way and back under the bench's interlocks.

    Parameters
    ----------
    bench
        The bench; lost counts do not stop the drive, for they are what is looked for.
    drive
        The signal generator, its outputs off.
    source
        The encoder's samples, not yet started.
    operator
        Who sets the load: none is asked for.

    Returns
    -------
    ShortDrive
        What was seen, up to where an interlock, the board or the card stopped it.
    """
    seen = ShortDrive()
    interlocks = replace(bench.interlocks, index_error_max_counts=None)
    instruments = Instruments(drive, source, operator)
    controller = SweepController(instruments, bench, interlocks, seen)
    try:
        controller.run(_dwells(seen, bench), 0)
    except BenchError as error:
        seen.error = error
    return seen


def _dwells(seen: ShortDrive, bench: BenchSettings) -> Iterator[Dwell]:
    """Yield dwells each way until the index has shown whole revolutions, or time is up."""
    low_hz, high_hz = bench.generator.frequency_limits_hz
    frequency_hz = min(max(USUAL_FREQUENCY_HZ, low_hz), high_hz)
    windows = max(2, round(_DWELL_S / bench.window_s))
    dwell_s = windows * bench.window_s
    number = 0
    for direction in (1, -1):
        pulses, elapsed_s = seen.pulses(), 0.0
        phases_deg = _phases_deg(bench, direction)
        while phases_deg and not _enough(seen, bench, elapsed_s, pulses):
            yield Dwell(
                number, 0, phases_deg[0], frequency_hz, 0.0, direction, windows, windows, None
            )
            number += 1
            elapsed_s += dwell_s
            still = seen.driven(direction).edges <= NO_MOTION_COUNTS
            if still and elapsed_s >= _STILL_AFTER_S and len(phases_deg) > 1:
                phases_deg.pop(0)


def _phases_deg(bench: BenchSettings, direction: int) -> list[float]:
    """Return the phases to drive at, within the limits of the lab."""
    limit_deg = bench.generator.phase_limits_deg[1 if direction > 0 else 0] * direction
    if limit_deg <= 0.0:
        return []
    return [copysign(min(phase_deg, limit_deg), direction) for phase_deg in PHASES_DEG]


def _enough(seen: ShortDrive, bench: BenchSettings, elapsed_s: float, pulses: int) -> bool:
    if elapsed_s < _LEAST_S:
        return False
    if bench.daq.index_counter is None or elapsed_s >= _LONGEST_S:
        return True
    return abs(seen.pulses() - pulses) >= _PULSES
