"""From the card's blocks to rows: decoded, stamped with what was commanded, and watched."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from usmbench.instruments.encoder import EncoderGeometry, EncoderState, WindowMotion, decode
from usmbench.instruments.samples import SampleBlock, SampleSource
from usmbench.settings.bench import BenchSettings, InterlockSettings
from usmbench.sweep.drive import CommandedDrive, Setting
from usmbench.sweep.interlocks import STILL_COUNTS, InterlockState, WindowSeen, watch
from usmbench.sweep.rows import WindowRow
from usmbench.sweep.settling import Settling

HEARTBEAT_S: Final = 0.25


@dataclass(frozen=True, slots=True)
class Start:
    """Where the rows begin; not at zero for a run that is taken up again.

    Parameters
    ----------
    t_s
        Time of the first sample.
    angle_rad
        Shaft angle there.
    """

    t_s: float = 0.0
    angle_rad: float = 0.0


FROM_ZERO: Final = Start()


@dataclass(frozen=True, slots=True)
class _Window:
    """The window read last."""

    block: SampleBlock
    motion: WindowMotion
    setting: Setting

    @property
    def end_sample(self) -> int:
        """Number of samples up to its end."""
        return self.block.first_sample + len(self.block.counts)


class WindowReader:
    """Reads windows one after another, and holds each against the interlocks.

    Parameters
    ----------
    source
        The encoder's samples.
    commands
        What was commanded, and when.
    bench
        What the bench file says.
    interlocks
        When the drive must go off.
    start
        Where the rows begin.
    """

    def __init__(
        self,
        source: SampleSource,
        commands: CommandedDrive,
        bench: BenchSettings,
        interlocks: InterlockSettings,
        start: Start = FROM_ZERO,
    ):
        self.interlocks = InterlockState()
        self._source = source
        self._commands = commands
        self._interlock_settings = interlocks
        self._start = start
        self._edge_timed = bench.encoder.speed == "edge_timed"
        self._geometry = EncoderGeometry(
            bench.counts_per_rev, source.counter_bits, bench.encoder.sign, source.sample_rate_hz
        )
        self._window_s = source.samples_per_block / source.sample_rate_hz
        self._heartbeat_samples = int(HEARTBEAT_S * source.sample_rate_hz)
        self._encoder = EncoderState()
        self._last: _Window | None = None

    def read(self, settling: Settling | None) -> tuple[SampleBlock, WindowRow]:
        """Return the next block and its row; before it, give the board a sign of life where due.

        Parameters
        ----------
        settling
            Takes the speed where the window belongs to what was commanded last; None where nothing
            is to settle.

        Raises
        ------
        usmbench.errors.DaqError
            The card has failed.
        usmbench.errors.BenchError
            The board does not answer.
        """
        if self._last is not None:
            # Not after the window: a command that follows it at once would wait on the line.
            self._commands.keep_alive(self._last.end_sample, self._heartbeat_samples)
        block = self._source.next_block()
        self._encoder, motion = decode(self._encoder, block, self._geometry)
        end_sample = block.first_sample + len(block.counts)
        setting = self._commands.in_force(end_sample)
        self._last = _Window(block, motion, setting)
        speed_rad_s = motion.edge_timed_rad_s if self._edge_timed else motion.average_rad_s
        # Windows that were on their way while the command was sent belong to no dwell.
        counts = settling is not None and end_sample > self._commands.complete_at
        row = WindowRow(
            self._start.t_s + end_sample / self._geometry.sample_rate_hz,
            setting.phase_deg,
            speed_rad_s,
            setting.frequency_hz,
            setting.torque_nm,
            self._start.angle_rad + motion.angle_rad,
            motion.window_s,
            setting.sweep,
            settling.add(speed_rad_s) if settling is not None and counts else 0,
            motion.average_rad_s,
            setting.drive_on,
            block.temperature_c,
        )
        return block, row

    def watch(self, *, hands_off: bool) -> None:
        """Hold the window read last against the interlocks.

        Parameters
        ----------
        hands_off
            Whether nobody may be turning the shaft by hand just now.

        Raises
        ------
        usmbench.errors.InterlockError
            An interlock tripped: the drive must go off.
        usmbench.errors.LostCountsError
            The index pulse shows that counts were lost.
        """
        last = self._last
        if last is None:
            return
        seen = self._seen(last, hands_off)
        self.interlocks = watch(self.interlocks, seen, self._interlock_settings)

    def _seen(self, last: _Window, hands_off: bool) -> WindowSeen:
        block, motion, setting = last.block, last.motion, last.setting
        edges = 0
        if abs(motion.counts) <= STILL_COUNTS and (
            setting.drive_on or motion.index_error_counts is not None
        ):
            edges = int(np.count_nonzero(np.diff(block.counts)))
        return WindowSeen(
            setting.phase_deg,
            setting.frequency_hz,
            setting.torque_nm,
            bool(setting.drive_on),
            motion.average_rad_s,
            motion.counts,
            edges,
            self._window_s,
            block.temperature_c,
            motion.index_error_counts,
            hands_off,
        )
