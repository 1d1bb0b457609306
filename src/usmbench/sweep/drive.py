"""What the sweep asks of the signal generator, and which command is in force in which window."""

from collections import deque
from dataclasses import dataclass, replace
from typing import Protocol

from usmbench.instruments.samples import SampleSource


class DriveControl(Protocol):
    """The part of the signal generator that a sweep uses."""

    phase_deg: float
    outputs_on: bool

    def set_drive(self, frequency_hz: float, phase_deg: float) -> None:
        """Set frequency and phase so that both take effect at one instant."""

    def heartbeat(self) -> None:
        """Give the board a sign of life."""

    def off(self) -> None:
        """Switch the outputs off."""


@dataclass(frozen=True, slots=True)
class Setting:
    """What was commanded.

    Parameters
    ----------
    phase_deg, frequency_hz, torque_nm
        Phase shift, drive frequency and load torque.
    sweep
        Number of the pass, -1 before the first.
    drive_on
        1 while the outputs are on.
    """

    phase_deg: float = 0.0
    frequency_hz: float = 0.0
    torque_nm: float = 0.0
    sweep: int = -1
    drive_on: int = 0


class CommandedDrive:
    """Commands the generator and knows which setting was in force when a window ended.

    Every command is bracketed between two readings of the number of samples the card has taken. A
    window that ended before the first belongs to the old setting, one that ended after the second
    to the new; one that ended in between is given to the nearer.

    Parameters
    ----------
    control
        The signal generator.
    source
        The running acquisition.
    """

    def __init__(self, control: DriveControl, source: SampleSource):
        self._control = control
        self._source = source
        self._commanded = Setting()
        self._in_force = Setting()
        self._pending: deque[tuple[float, Setting]] = deque()
        self._complete_at = 0
        self._last_contact = 0

    def begin(self, at_rest: Setting) -> None:
        """Say what the rows before the first command are to carry.

        Parameters
        ----------
        at_rest
            The operating point to come, without drive.
        """
        self._commanded = self._in_force = at_rest

    @property
    def complete_at(self) -> int:
        """Number of samples that the card had taken when the last command was acknowledged."""
        return self._complete_at

    def in_force(self, end_sample: int) -> Setting:
        """Return the setting in force at the end of a window; asked in the order of the windows.

        Parameters
        ----------
        end_sample
            Number of samples up to the window's end.
        """
        while self._pending and self._pending[0][0] < end_sample:
            self._in_force = self._pending.popleft()[1]
        return self._in_force

    def apply(self, setting: Setting) -> None:
        """Command a setting with the drive on; sends no more than has changed.

        Parameters
        ----------
        setting
            The setting; the drive is on whatever its `drive_on` says.
        """
        setting = replace(setting, drive_on=1)
        last = self._commanded
        before = self._source.samples_acquired()
        sent = True
        if not last.drive_on or setting.frequency_hz != last.frequency_hz:
            self._control.set_drive(setting.frequency_hz, setting.phase_deg)
        elif setting.phase_deg != last.phase_deg:
            self._control.phase_deg = setting.phase_deg
        else:
            sent = False
        if not last.drive_on:
            self._control.outputs_on = True
        self._note(setting, before, sent=sent)

    def rest(self) -> None:
        """Switch the drive off between two parts of a plan.

        The phase goes to 0 as well: rows without drive then say what a motor does at φ = 0, and
        no reader takes them for a motor that stands still at full drive.
        """
        last = self._commanded
        before = self._source.samples_acquired()
        self._control.off()
        if last.drive_on:
            self._control.set_drive(last.frequency_hz, 0.0)
        self._note(replace(last, phase_deg=0.0, drive_on=0), before, sent=True)

    def _note(self, setting: Setting, before: int, *, sent: bool) -> None:
        after = self._source.samples_acquired()
        self._commanded = setting
        self._pending.append(((before + after) / 2, setting))
        self._complete_at = after
        if sent:
            self._last_contact = after

    def keep_alive(self, end_sample: int, every_samples: int) -> None:
        """Send a sign of life where the last exchange was too long ago, in sample time.

        Parameters
        ----------
        end_sample
            Number of samples up to the end of the window just handled.
        every_samples
            Longest silence.
        """
        if end_sample - self._last_contact >= every_samples:
            self._control.heartbeat()
            self._last_contact = end_sample

    def off(self) -> None:
        """Switch the drive off, whatever is under way."""
        self._control.off()
