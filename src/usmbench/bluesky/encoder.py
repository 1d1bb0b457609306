"""The encoder as bluesky devices: the settled speed, and every window."""

import time
from collections.abc import Iterator

from bluesky.protocols import Hints
from event_model import PartialEvent

from usmbench.bluesky.loop import BenchLoop
from usmbench.bluesky.requests import Measurement
from usmbench.bluesky.signals import Keys, Readings, data_key
from usmbench.bluesky.status import DeviceStatus
from usmbench.errors import BenchError
from usmbench.settings.plan import DwellSettings
from usmbench.sweep.rows import WindowRow


class Encoder:
    """The settled speed after the last command: Readable, Triggerable, Pausable.

    Parameters
    ----------
    loop
        The running bench.
    dwell
        When a speed counts as settled, as in a plan's `dwell`.
    """

    parent = None
    name = "encoder"

    def __init__(self, loop: BenchLoop, dwell: DwellSettings):
        self._loop = loop
        self._dwell = dwell
        self._measurement: Measurement | None = None
        self._at_s = 0.0

    @property
    def hints(self) -> Hints:
        """What a plot of a scan shows."""
        return {"fields": ["speed_rad_s"]}

    def trigger(self) -> DeviceStatus:
        """Measure the speed.

        Returns
        -------
        DeviceStatus
            Done when the speed has settled, or the dwell has run out of windows.
        """
        self._measurement = self._loop.measure(self._dwell)
        return self._measurement.status

    def read(self) -> Readings:
        """Return the speed measured last.

        Raises
        ------
        usmbench.errors.BenchError
            None was measured.
        """
        measurement = self._measurement
        if measurement is None or measurement.row is None:
            raise BenchError("no speed was measured; trigger the encoder before it is read")
        mean_rad_s, deviation_rad_s, n_windows = measurement.settling.pair()
        values = {
            "speed_rad_s": mean_rad_s,
            "speed_std_rad_s": deviation_rad_s,
            "n_windows": n_windows,
            "settled": int(measurement.settling.n_settled > 0),
            "angle_rad": measurement.row.angle_rad,
            "t_s": measurement.row.t_s,
            "torque_nm": measurement.row.torque_nm,
        }
        at_s = time.time()
        return {name: {"value": value, "timestamp": at_s} for name, value in values.items()}

    def describe(self) -> Keys:
        """Return the data keys."""
        return {
            "speed_rad_s": data_key("encoder", "rad/s"),
            "speed_std_rad_s": data_key("encoder", "rad/s"),
            "n_windows": data_key("encoder", dtype="integer"),
            "settled": data_key("encoder", dtype="integer"),
            "angle_rad": data_key("encoder", "rad"),
            "t_s": data_key("encoder.clock", "s"),
            "torque_nm": data_key("operator", "N·m"),
        }

    def read_configuration(self) -> Readings:
        """Return how the speed is measured."""
        settings = self._loop.settings
        values = {
            "counts_per_rev": settings.counts_per_rev,
            "sample_rate_hz": settings.daq.sample_rate_hz,
            "samples_per_average": settings.daq.samples_per_average,
            "dwell_windows": self._dwell.windows,
        }
        return {name: {"value": value, "timestamp": self._at_s} for name, value in values.items()}

    def describe_configuration(self) -> Keys:
        """Return the data keys of the configuration."""
        return {
            "counts_per_rev": data_key("bench", dtype="integer"),
            "sample_rate_hz": data_key("bench", "Hz"),
            "samples_per_average": data_key("bench", dtype="integer"),
            "dwell_windows": data_key("plan", dtype="integer"),
        }

    def pause(self) -> None:
        """Switch the drive off and forget a measurement under way: the plan begins it again.

        Raises
        ------
        usmbench.errors.BenchError
            The board cannot be reached.
        """
        self._measurement = None
        self._loop.rest()

    def resume(self) -> None:
        """Go on: the plan triggers again."""


WINDOW_KEYS: Keys = {
    "t_s": data_key("encoder.clock", "s"),
    "phase_deg": data_key("generator.phase", "deg"),
    "speed_rad_s": data_key("encoder", "rad/s"),
    "frequency_hz": data_key("generator.frequency", "Hz"),
    "torque_nm": data_key("operator", "N·m"),
    "angle_rad": data_key("encoder", "rad"),
    "window_s": data_key("encoder.clock", "s"),
    "drive_on": data_key("generator", dtype="integer"),
}


class Windows:
    """Every window between kickoff and complete, 100 a second: Flyable.

    Parameters
    ----------
    loop
        The running bench.
    """

    parent = None
    name = "windows"

    def __init__(self, loop: BenchLoop):
        self._loop = loop
        self._rows: list[tuple[WindowRow, float]] = []

    def kickoff(self) -> DeviceStatus:
        """Begin to keep windows."""
        self._rows = []
        # A plan that was aborted did not complete what it had kicked off.
        if self._keep not in self._loop.listeners:
            self._loop.listeners.append(self._keep)
        return _done()

    def _keep(self, row: WindowRow, at_s: float) -> None:
        self._rows.append((row, at_s))

    def complete(self) -> DeviceStatus:
        """Keep no further windows."""
        if self._keep in self._loop.listeners:
            self._loop.listeners.remove(self._keep)
        return _done()

    def collect(self) -> Iterator[PartialEvent]:
        """Yield an event for each window that was kept."""
        rows, self._rows = self._rows, []
        for row, at_s in rows:
            data = {name: getattr(row, name) for name in WINDOW_KEYS}
            yield {"time": at_s, "data": data, "timestamps": dict.fromkeys(data, at_s)}

    def describe_collect(self) -> dict[str, Keys]:
        """Return the data keys of the stream."""
        return {self.name: WINDOW_KEYS}


def _done() -> DeviceStatus:
    status = DeviceStatus()
    status.end()
    return status
