"""Motor, shaft and disc as one machine: the same calls give the same samples."""

from collections import deque
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from hil_sim.plant.disc import Channel, Disc, DiscError
from hil_sim.plant.motion import Motion
from hil_sim.plant.parameters import PlantParameters
from hil_sim.plant.rotor import ShaftLoad
from hil_sim.signals import Drive, Samples

# Longest stretch followed at once, which bounds the memory at low sample rates.
_STRETCH_S = 1.0
# Rounding that a caller's sum of times may have; less than any sample period.
_TIME_ROUNDING_S = 1e-9


class MotorPlant:
    """A USR60 on its testbed; implements `hil_sim.signals.Plant`.

    Parameters
    ----------
    parameters
        The motor.
    seed
        Seed of the torque noise.
    load
        What else hangs on the shaft, or None.
    disc_error
        How the disc's pattern departs from the shaft's angle; None where it does not.
    """

    def __init__(
        self,
        parameters: PlantParameters | None = None,
        seed: int = 0,
        *,
        load: ShaftLoad | None = None,
        disc_error: DiscError | None = None,
    ):
        parameters = PlantParameters() if parameters is None else parameters
        self._motion = Motion(parameters, seed, load)
        self._disc = Disc(parameters.disc, disc_error)
        self._commands: deque[tuple[float, Callable[[], None]]] = deque()
        self._latest_s = 0.0
        self._clock_start_s, self._clock_rate_hz, self._clock_samples = 0.0, 1.0, 0

    @property
    def speed_rad_s(self) -> float:
        """Speed of the shaft where the integration stands: for comparison, no sensor shows it."""
        return self._motion.shaft.speed_rad_s

    def drive(self, time_s: float, drive: Drive) -> None:
        """Change the drive voltages.

        Parameters
        ----------
        time_s
            When; not before any earlier call's time nor before a sample already taken.
        drive
            The voltages.

        Raises
        ------
        ValueError
            The time is in the past.
        """
        self._at(time_s, partial(self._motion.set_drive, drive))

    def set_load(self, time_s: float, torque_nm: float) -> None:
        """Change the load, a brake that acts against any motion.

        Parameters
        ----------
        time_s
            When, as for `drive`.
        torque_nm
            Torque of the brake, at least 0.

        Raises
        ------
        ValueError
            The time is in the past, or the torque negative.
        """
        if not torque_nm >= 0.0:
            raise ValueError(f"A brake's torque is at least 0 N·m, not {torque_nm}")
        self._at(time_s, partial(self._motion.set_brake, torque_nm))

    def set_coupling(self, time_s: float, coupled: bool) -> None:
        """Let the coupling of the disc slip, or hold again.

        Parameters
        ----------
        time_s
            When, as for `drive`.
        coupled
            False: the shaft turns and the disc does not.

        Raises
        ------
        ValueError
            The time is in the past.
        """
        self._at(time_s, lambda: self._disc.set_coupling(coupled, self._motion.shaft))

    def set_dead_channel(self, time_s: float, channel: Channel | None) -> None:
        """Let an encoder channel stick at its level, so that X4 counts go up and down by one.

        Parameters
        ----------
        time_s
            When, as for `drive`.
        channel
            "a", "b", or None where both work.

        Raises
        ------
        ValueError
            The time is in the past.
        """
        self._at(time_s, lambda: self._disc.set_dead_channel(channel, self._motion.shaft))

    def sample(self, n_samples: int, sample_rate_hz: float) -> Samples:
        """Take the next samples and move time on by as many sample periods.

        Parameters
        ----------
        n_samples
            Number of samples, at least 1.
        sample_rate_hz
            Rate of the sample clock.

        Returns
        -------
        Samples
            Count, index pulses and temperature; the first sample is at the time reached before.

        Raises
        ------
        ValueError
            Fewer than one sample, or a rate that is not positive.
        """
        if n_samples < 1 or not sample_rate_hz > 0.0:
            raise ValueError(f"{n_samples} samples at {sample_rate_hz} Hz cannot be taken")
        times_s = self._clock(n_samples, sample_rate_hz)
        stretch = max(1, int(_STRETCH_S * sample_rate_hz))
        parts = []
        first = 0
        while first < n_samples:
            end = min(first + stretch, n_samples)
            if self._commands and self._commands[0][0] <= times_s[end - 1]:
                end = first + int(np.searchsorted(times_s[first:end], self._commands[0][0]))
                if end == first:
                    self._next_command()
                    continue
            parts.append(self._read(times_s[first:end]))
            first = end
        position, pulses = (
            parts[0] if len(parts) == 1 else map(np.concatenate, zip(*parts, strict=True))
        )
        return Samples(position, pulses, self._motion.temperature_c)

    def _at(self, time_s: float, command: Callable[[], None]) -> None:
        """Queue a command until the samples before it have been taken."""
        if not time_s >= self._latest_s - _TIME_ROUNDING_S:
            raise ValueError(f"Time {time_s} s is before {self._latest_s} s, which has passed")
        self._latest_s = max(time_s, self._latest_s)
        self._commands.append((self._latest_s, command))

    def _clock(self, n_samples: int, sample_rate_hz: float) -> NDArray[np.float64]:
        """Return the times of the next samples, from whole numbers so that they never drift."""
        if sample_rate_hz != self._clock_rate_hz:
            self._clock_start_s += self._clock_samples / self._clock_rate_hz
            self._clock_rate_hz, self._clock_samples = sample_rate_hz, 0
        first = self._clock_samples
        self._clock_samples += n_samples
        times_s = np.arange(float(first), float(self._clock_samples + 1)) / sample_rate_hz
        if self._clock_start_s:
            times_s += self._clock_start_s
        self._latest_s = max(self._latest_s, float(times_s[-1]))
        return times_s[:-1]

    def _next_command(self) -> None:
        """Bring the motor to the next command's time and carry it out."""
        time_s, command = self._commands.popleft()
        self._motion.follow_to(time_s)
        command()

    def _read(self, times_s: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Follow the motor past the last of the times and read the disc at all of them."""
        until_s = float(times_s[-1])
        self._motion.follow_past(until_s)
        counts = self._disc.read(times_s, self._motion.path)
        self._motion.forget_before(until_s)
        return counts
