"""The drive's settings as bluesky devices."""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import replace

from bluesky.protocols import Hints, Location
from event_model import DataKey

from usmbench.bluesky.loop import BenchLoop
from usmbench.bluesky.signals import Keys, Readings, data_key
from usmbench.bluesky.status import DeviceStatus
from usmbench.sweep.drive import Setting


class _Knob(ABC):
    """A setting of the drive: Movable, Readable, Locatable, Stoppable and Checkable."""

    parent = None

    def __init__(self, name: str, loop: BenchLoop, key: DataKey, check: Callable[[float], object]):
        self.name = name
        self._loop = loop
        self._key = key
        self._check = check

    @property
    def hints(self) -> Hints:
        """What a plot of a scan has on its axis."""
        return {"fields": [self.name]}

    def describe(self) -> Keys:
        """Return the data key."""
        return {self.name: self._key}

    def read(self) -> Readings:
        """Return what is commanded."""
        return {self.name: {"value": self._value(self._loop.setting), "timestamp": time.time()}}

    def read_configuration(self) -> Readings:
        """Return nothing: there is no configuration."""
        return {}

    def describe_configuration(self) -> Keys:
        """Return nothing: there is no configuration."""
        return {}

    def locate(self) -> Location[float]:
        """Return setpoint and readback, which the board keeps the same."""
        value = self._value(self._loop.setting)
        return {"setpoint": value, "readback": value}

    def check_value(self, value: float) -> None:
        """Refuse a value that lab or board do not allow.

        Parameters
        ----------
        value
            Phase shift in degrees, or frequency in hertz.

        Raises
        ------
        usmbench.errors.InputError
            It is out of range.
        """
        self._check(value)

    def set(self, value: float) -> DeviceStatus:
        """Command a value.

        Parameters
        ----------
        value
            Phase shift in degrees, or frequency in hertz.

        Returns
        -------
        DeviceStatus
            Done when the board has acknowledged.

        Raises
        ------
        usmbench.errors.InputError
            It is out of range; nothing was sent.
        """
        self._check(value)
        return self._loop.change(lambda old: self._changed(old, float(value)))

    def stop(self, *, success: bool = True) -> None:
        """Switch the drive off; the RunEngine calls this on any exit, pause and suspension.

        Parameters
        ----------
        success
            Whether the plan went well; the drive goes off either way.
        """
        self._loop.rest()

    @abstractmethod
    def _value(self, setting: Setting) -> float:
        """Return this knob's value in a setting of the drive."""

    @abstractmethod
    def _changed(self, setting: Setting, value: float) -> Setting:
        """Return the setting of the drive that commanding a value leads to."""


class Phase(_Knob):
    """Phase shift φ of generator B against A; setting it switches the drive on.

    Parameters
    ----------
    loop
        The running bench.
    check
        Refuses a phase that lab or board do not allow.
    """

    def __init__(self, loop: BenchLoop, check: Callable[[float], object]):
        limits = loop.settings.generator.phase_limits_deg
        key = data_key("generator.phase", "deg", limits=limits)
        super().__init__("phase_deg", loop, key, check)

    def _value(self, setting: Setting) -> float:
        return setting.phase_deg

    def _changed(self, setting: Setting, value: float) -> Setting:
        return replace(setting, phase_deg=value, drive_on=1)


class Frequency(_Knob):
    """Frequency of both drive voltages; kept for later while the drive is off.

    Parameters
    ----------
    loop
        The running bench.
    check
        Refuses a frequency that lab or board do not allow.
    """

    def __init__(self, loop: BenchLoop, check: Callable[[float], object]):
        limits = loop.settings.generator.frequency_limits_hz
        key = data_key("generator.frequency", "Hz", limits=limits)
        super().__init__("frequency_hz", loop, key, check)

    def _value(self, setting: Setting) -> float:
        return setting.frequency_hz

    def _changed(self, setting: Setting, value: float) -> Setting:
        return replace(setting, frequency_hz=value)
