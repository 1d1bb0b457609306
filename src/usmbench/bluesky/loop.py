"""The thread that alone talks to board and card while bluesky drives the bench."""

import queue
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Final

from usmbench.bluesky.late_failures import LateFailures
from usmbench.bluesky.requests import Acknowledgement, Change, Measurement, Request, Wanted
from usmbench.bluesky.signals import Signal, data_key
from usmbench.bluesky.status import DeviceStatus
from usmbench.errors import BenchError, InterlockError, LostCountsError
from usmbench.instruments.samples import SampleSource
from usmbench.settings.bench import BenchSettings
from usmbench.settings.plan import DwellSettings
from usmbench.sweep.drive import CommandedDrive, DriveControl, Setting
from usmbench.sweep.interlocks import InterlockState
from usmbench.sweep.rows import WindowRow
from usmbench.sweep.settling import Settling
from usmbench.sweep.window_reader import WindowReader

# A window, a command with all its repeats, and a busy machine.
_STOP_TIMEOUT_S: Final = 5.0


class BenchLoop:
    """Reads windows, watches the interlocks, and carries out commands between two windows.

    Parameters
    ----------
    drive
        The signal generator, its outputs off.
    source
        The encoder's samples, not yet started.
    settings
        What the bench file says; its interlocks hold throughout.
    at_rest
        Frequency and load before the first command.
    """

    def __init__(
        self,
        drive: DriveControl,
        source: SampleSource,
        settings: BenchSettings,
        at_rest: Setting,
    ):
        self.ready = Signal("ready", data_key("interlocks", dtype="boolean"), value=True)
        self.speed = Signal("live_speed_rad_s", data_key("encoder", "rad/s"), 0.0)
        self.temperature = Signal("temperature_c", data_key("sensor", "°C"), 0.0)
        self.settings = settings
        self.listeners: list[Callable[[WindowRow, float], None]] = []
        self._source = source
        self._setting = at_rest
        self._commands = CommandedDrive(drive, source)
        self._commands.begin(at_rest)
        self._reader = WindowReader(source, self._commands, settings, settings.interlocks)
        self._requests: queue.SimpleQueue[Request] = queue.SimpleQueue()
        self._measurement: Measurement | None = None
        self._failures = LateFailures()
        self._trip: BenchError | None = None
        self._broken = False
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="usmbench bluesky", daemon=True)

    def start(self) -> None:
        """Start the acquisition and the thread.

        Raises
        ------
        usmbench.errors.DaqError
            The card cannot be started.
        """
        self._source.start()
        self._thread.start()

    def close(self) -> None:
        """Switch the drive off and end the thread.

        Raises
        ------
        usmbench.errors.BenchError
            The thread does not end.
        """
        self._closing.set()
        self._thread.join(_STOP_TIMEOUT_S + self.settings.daq.no_data_timeout_s)
        if self._thread.is_alive():
            raise BenchError("the bench's loop does not end; cut the power of the amplifiers")

    @property
    def setting(self) -> Setting:
        """What was commanded last."""
        return self._setting

    def change(self, change: Change) -> DeviceStatus:
        """Have the drive changed, and on afterwards.

        Parameters
        ----------
        change
            From the setting before to the one after.

        Returns
        -------
        DeviceStatus
            Done when the board has acknowledged; fails where an interlock has tripped.
        """
        status = DeviceStatus()
        self._requests.put((change, status))
        return status

    def rest(self) -> None:
        """Switch the drive off; what is under way ends, a measurement without its row.

        Raises
        ------
        usmbench.errors.BenchError
            The board cannot be reached.
        """
        status = DeviceStatus()
        self._requests.put((None, status))
        if self._thread.is_alive():
            status.wait(_STOP_TIMEOUT_S)

    def measure(self, dwell: DwellSettings) -> Measurement:
        """Have the speed measured from the windows after the last command.

        Parameters
        ----------
        dwell
            When it counts as settled.
        """
        measurement = Measurement(dwell, DeviceStatus(), Settling(dwell.settle))
        self._requests.put((measurement, measurement.status))
        return measurement

    def acknowledge(self) -> None:
        """Say that what tripped an interlock has been mended: commands are taken again.

        What was asked for before still fails, and one that trips meanwhile holds.
        """
        self._requests.put((Acknowledgement(self._trip), DeviceStatus()))

    def _run(self) -> None:
        try:
            while not self._closing.is_set():
                self._carry_out()
                self._window()
        except BenchError as error:
            self._break_with(error)
        except BaseException as error:
            self._break_with(BenchError(f"the bench's loop failed: {error!r}"))
            raise
        finally:
            with suppress(BenchError):
                # The generator's own context tries again, several times.
                self._commands.off()
            self._refuse_all()

    def _carry_out(self) -> None:
        """Carry out what was asked for since the last window."""
        while not self._requests.empty():
            wanted, status = self._requests.get()
            try:
                self._answer(wanted, status)
            except BenchError as error:
                status.end(error)
                raise

    def _answer(self, wanted: Wanted, status: DeviceStatus) -> None:
        if wanted is None:
            self._commands.rest()
            self._setting = replace(self._setting, phase_deg=0.0, drive_on=0)
            self._end_all()
        elif isinstance(wanted, Acknowledgement):
            if wanted.trip is self._trip:
                self._trip = None
                self.ready.put(value=True, at_s=time.time())
        elif self._trip is not None:
            self._failures.add(status, self._trip)
            return
        elif isinstance(wanted, Measurement):
            if self._measurement is not None:
                self._measurement.status.end()
            self._measurement = wanted
            return
        else:
            setting = wanted(self._setting)
            if setting.drive_on:
                self._commands.apply(setting)
            self._setting = setting
        status.end()

    def _window(self) -> None:
        measurement = self._measurement
        _, row = self._reader.read(measurement.settling if measurement else None)
        at_s = time.time()
        try:
            self._reader.watch(hands_off=True)
        except (InterlockError, LostCountsError) as error:
            self._tripped(error)
            measurement = None
        self.speed.put(row.speed_rad_s, at_s)
        if row.temperature_c is not None:
            self.temperature.put(row.temperature_c, at_s)
        self.ready.tell_again()
        for listener in list(self.listeners):
            listener(row, at_s)
        if measurement is not None and self._trip is None:
            self._finish(measurement, row)
        self._failures.end_due()

    def _finish(self, measurement: Measurement, row: WindowRow) -> None:
        """End a measurement that has what it needs."""
        dwell = measurement.dwell
        if measurement.settling.has_enough(dwell.windows, dwell.extend_to_windows):
            measurement.row = row
            self._measurement = None
            measurement.status.end()

    def _tripped(self, error: BenchError) -> None:
        """Switch off, tell the suspenders, and have what is under way fail a little later."""
        self._commands.rest()
        # The plan may yet read what a speed was measured at that is done.
        self._setting = replace(self._setting, drive_on=0)
        # Just switched off: the motor may still be turning.
        self._reader.interlocks = InterlockState(off_s=0.0)
        self._trip = error
        if self.ready.get():
            self.ready.put(value=False, at_s=time.time())
        measurement, self._measurement = self._measurement, None
        if measurement is not None:
            self._failures.add(measurement.status, error)

    def _break_with(self, error: BenchError) -> None:
        self._trip = error
        self._broken = True
        self.ready.put(value=False, at_s=time.time())

    def _end_all(self, error: BenchError | None = None) -> None:
        """End what is under way: a plan taken up again may wait for it beside the new."""
        measurement, self._measurement = self._measurement, None
        self._failures.end_all(error)
        if measurement is not None:
            measurement.status.end(error)

    def _refuse_all(self) -> None:
        """Answer what is asked once the loop has ended, until nobody asks any more."""
        ended = self._trip or BenchError("the bench has been closed; open it again")
        while self._broken and not self._closing.wait(0.05):
            self._refuse(ended)
        self._refuse(ended)

    def _refuse(self, error: BenchError) -> None:
        while not self._requests.empty():
            wanted, status = self._requests.get()
            status.end(None if wanted is None else error)
        self._end_all(error)
