"""Runs a schedule: one loop that reads windows, watches them and commands the drive."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import chain

from usmbench.errors import BenchError
from usmbench.instruments.samples import SampleSource
from usmbench.settings.bench import BenchSettings, InterlockSettings
from usmbench.sweep.drive import CommandedDrive, DriveControl, Setting
from usmbench.sweep.interrupts import Interrupts, deferred_interrupts
from usmbench.sweep.observer import Observer, Standing
from usmbench.sweep.operator import Operator
from usmbench.sweep.rows import PairRow, Sink
from usmbench.sweep.schedule import Dwell
from usmbench.sweep.settling import Settling
from usmbench.sweep.summary import WINDOWS_BEFORE, windows_after
from usmbench.sweep.window_reader import FROM_ZERO, Start, WindowReader


@dataclass(frozen=True, slots=True)
class Instruments:
    """What a sweep drives and reads.

    Parameters
    ----------
    drive
        The signal generator, its outputs off.
    source
        The encoder's samples, not yet started.
    operator
        Who sets the load.
    """

    drive: DriveControl
    source: SampleSource
    operator: Operator


class SweepController:
    """Drives dwells, one after another, and hands every window to a sink.

    Parameters
    ----------
    instruments
        What is driven and read.
    bench
        What the bench file says.
    interlocks
        When the drive must go off: the bench's limits, tightened by the plan's.
    sink
        Where windows and pairs go.
    observer
        Is told of every window and pair, or None.
    ask_operator
        Whether the operator is asked to set each load.
    start
        Where the rows begin.
    check_stop
        Raises KeyboardInterrupt where somebody else than the user at the keyboard wants to stop;
        called before every window, or None.
    """

    def __init__(
        self,
        instruments: Instruments,
        bench: BenchSettings,
        interlocks: InterlockSettings,
        sink: Sink,
        *,
        observer: Observer | None = None,
        ask_operator: bool = False,
        start: Start = FROM_ZERO,
        check_stop: Callable[[], None] | None = None,
    ):
        source = instruments.source
        self._instruments = instruments
        self._interlock_settings = interlocks
        self._sink = sink
        self._observer = observer
        self._ask_operator = ask_operator
        self._check_stop = check_stop
        self._commands = CommandedDrive(instruments.drive, source)
        self._reader = WindowReader(source, self._commands, bench, interlocks, start)
        self._window_s = source.samples_per_block / source.sample_rate_hz
        self._torque_nm: float | None = None
        self._hands_off = True
        self._windows_left = 0
        self._interrupts = Interrupts()

    def run(self, dwells: Iterable[Dwell], n_windows: int) -> None:
        """Drive the dwells; however this ends, the drive is switched off first.

        Parameters
        ----------
        dwells
            The schedule.
        n_windows
            Windows that are planned in all, for the time remaining.

        Raises
        ------
        KeyboardInterrupt
            The user stopped the run.
        usmbench.errors.BenchError
            The board, the card, the disk or an interlock stopped it.
        """
        self._windows_left = n_windows
        remaining = iter(dwells)
        first = next(remaining, None)
        if first is None:
            return
        at_rest = Setting(frequency_hz=first.frequency_hz, torque_nm=first.torque_nm)
        self._commands.begin(at_rest)
        with deferred_interrupts() as self._interrupts:
            try:
                self._instruments.source.start()
                self._rest(WINDOWS_BEFORE)
                for dwell in chain([first], remaining):
                    self._hold(dwell)
                self._commands.rest()
                self._rest(windows_after(self._interlock_settings, self._window_s))
            except BaseException as error:
                self._off_after(error)
                raise
            self._commands.off()

    def _off_after(self, error: BaseException) -> None:
        """Switch the drive off; what stopped the run stays the error that is seen."""
        try:
            self._commands.off()
        except BenchError as failure:
            # The generator tries again, over a port opened anew, as its own context ends.
            error.add_note(f"switching the outputs off failed: {failure}")

    def _rest(self, n_windows: int) -> None:
        """Read windows without drive; motion trips the interlock."""
        for _ in range(n_windows):
            self._window(None)

    def _hold(self, dwell: Dwell) -> None:
        """Drive one dwell until it has its windows, and keep its pair."""
        if dwell.torque_nm != self._torque_nm:
            self._set_load(dwell.torque_nm)
        setting = Setting(dwell.phase_deg, dwell.frequency_hz, dwell.torque_nm, dwell.sweep, 1)
        self._commands.apply(setting)
        settling = Settling(dwell.settle)
        t_s = 0.0
        left_after = self._windows_left - dwell.windows
        while not settling.has_enough(dwell.windows, dwell.extend_to_windows):
            t_s = self._window(settling)
            self._windows_left = left_after + max(dwell.windows - settling.n_windows, 0)
        self._windows_left = left_after
        if dwell.settle is not None:
            self._keep_pair(dwell, settling, t_s)

    def _set_load(self, torque_nm: float) -> None:
        """Have the load set, with the drive off; the windows go on meanwhile."""
        operator = self._instruments.operator
        self._hands_off = False
        if self._ask_operator:
            if self._torque_nm is not None:
                self._commands.rest()
            # Who watches knows before the question is on the terminal.
            self._window(None)
        operator.set_load(torque_nm, ask=self._ask_operator)
        while not self._load_is_set():
            self._window(None)
        self._hands_off = True
        self._torque_nm = torque_nm

    def _load_is_set(self) -> bool:
        try:
            return self._instruments.operator.load_is_set()
        except BenchError:
            # A terminal that is closed ends the input, and its signal may come a moment later.
            self._window(None)
            self._interrupts.check()
            raise

    def _keep_pair(self, dwell: Dwell, settling: Settling, t_s: float) -> None:
        mean_rad_s, deviation_rad_s, n_windows = settling.pair()
        pair = PairRow(
            dwell.phase_deg,
            dwell.frequency_hz,
            dwell.torque_nm,
            mean_rad_s,
            deviation_rad_s,
            n_windows,
            dwell.direction,
            t_s,
            dwell.number,
            int(settling.n_settled > 0),
        )
        self._sink.pair(pair)
        if self._observer is not None:
            self._observer.settled(pair)

    def _window(self, settling: Settling | None) -> float:
        """Read, keep and watch one window; return its end."""
        self._interrupts.check()
        if self._check_stop is not None:
            self._check_stop()
        block, row = self._reader.read(settling)
        self._sink.raw(block)
        self._sink.window(row)
        self._reader.watch(hands_off=self._hands_off)
        if self._observer is not None:
            standing = Standing(self._windows_left, self._reader.interlocks, not self._hands_off)
            self._observer.window(row, standing)
        return row.t_s
