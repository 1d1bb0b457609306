"""Motor, shaft and disc as one machine: the same calls give the same samples.

Time runs on a fixed grid of ticks. A command that falls inside a tick splits it; where samples
beyond the command's tick were already integrated, that tick is done again up to the command.
Every tick's noise is addressed by the tick's number. So neither the size of the blocks nor the
sample rate changes the motion.
"""

from collections import deque
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hil_sim.plant.contact import Contact, Grip
from hil_sim.plant.disc import Channel, Disc
from hil_sim.plant.noise import BLOCK, TorqueNoise
from hil_sim.plant.parameters import PlantParameters
from hil_sim.plant.rotor import Rotor, RotorState
from hil_sim.plant.stator import Stator
from hil_sim.plant.thermal import HeatMeter, Thermal
from hil_sim.signals import Drive, Samples

TICKS_PER_S = 2000
"""Ticks a second: 0.5 ms resolves the rotor's 3 ms and the envelopes' 0.5 ms."""

_THERMAL_TICKS = 256
# Longest stretch integrated at once, which bounds the memory at low sample rates.
_STRETCH_S = 1.0
# Keeps a rest from ending beyond a command through rounding, in ticks.
_TICK_ROUNDING = 1e-4
# Rounding that a caller's sum of times may have; less than any sample period.
_TIME_ROUNDING_S = 1e-9


class _Mark(NamedTuple):
    """State before the last step, to which a command inside it returns."""

    now_s: float
    tick: int
    pieces: int
    rotor: RotorState
    envelopes: tuple[complex, complex]
    grip: Grip
    heat: HeatMeter


class MotorPlant:
    """A USR60 on its testbed; implements `hil_sim.signals.Plant`.

    Parameters
    ----------
    parameters
        The motor.
    seed
        Seed of the torque noise.
    """

    def __init__(self, parameters: PlantParameters | None = None, seed: int = 0):
        p = PlantParameters() if parameters is None else parameters
        self._stator = Stator(p.stator)
        self._contact = Contact(p.contact)
        self._rotor = Rotor(p.rotor)
        self._thermal = Thermal(p.thermal, _THERMAL_TICKS / TICKS_PER_S)
        self._disc = Disc(p.disc)
        self._noise = TorqueNoise(
            seed, p.rotor.noise_nm, p.rotor.noise_correlation_s, 1.0 / TICKS_PER_S
        )
        self._noise_block = -1
        self._noise_nm: list[float] = []
        self._noise_bound_nm = 0.0
        self._drive = Drive()
        self._commands: deque[tuple[float, Callable[[], None]]] = deque()
        self._latest_s = 0.0
        self._clock_start_s, self._clock_rate_hz, self._clock_samples = 0.0, 1.0, 0
        self._now_s = 0.0
        self._tick, self._warm_tick = 0, _THERMAL_TICKS
        self._grip = self._contact.grip(self._stator.vibration)
        self._mark = self._state()

    @property
    def speed_rad_s(self) -> float:
        """Speed of the shaft where the integration stands: for comparison, no sensor shows it."""
        return self._rotor.state.speed_rad_s

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
        self._at(time_s, partial(self._set_drive, drive))

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
        self._at(time_s, partial(self._rotor.set_brake, torque_nm))

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
        self._at(time_s, lambda: self._disc.set_coupling(coupled, self._rotor.state))

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
        self._at(time_s, lambda: self._disc.set_dead_channel(channel, self._rotor.state))

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
        return Samples(position, pulses, self._thermal.temperature_c)

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
        """Bring the machines to the next command's time and carry it out."""
        time_s, command = self._commands.popleft()
        if time_s < self._now_s:
            self._return_to(self._mark)
        while self._now_s < time_s:
            self._step(time_s, time_s)
        command()
        self._regrip()

    def _read(self, times_s: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Integrate past the last of the times and read the disc at all of them."""
        until_s = float(times_s[-1])
        while self._now_s <= until_s:
            self._step(until_s, np.inf)
        path = self._rotor.path
        counts = self._disc.read(times_s, path)
        gone = len(path) - 1
        while path[gone][0] > until_s:
            gone -= 1
        del path[:gone]
        self._mark = self._mark._replace(pieces=max(0, self._mark.pieces - gone))
        return counts

    def _step(self, until_s: float, stop_s: float) -> None:
        """Integrate some ticks towards `until_s`, the last one only as far as `stop_s`."""
        if self._tick >= self._warm_tick:
            self._warm()
        block, number = divmod(self._tick, BLOCK)
        if block != self._noise_block:
            self._noise_block, self._noise_nm = block, self._noise.block(block)
            self._noise_bound_nm = max(map(abs, self._noise_nm))
        end_tick = self._tick + 1
        gliding = self._stator.settled
        if gliding:
            whole = int(until_s * TICKS_PER_S - _TICK_ROUNDING)
            end_tick = max(end_tick, min(whole, self._warm_tick, (block + 1) * BLOCK))
        end_s = end_tick / TICKS_PER_S
        if end_s > until_s:
            self._mark = self._state()
        if gliding:
            self._glide(end_tick, min(end_s, stop_s), number)
        else:
            self._swing(min(end_s, stop_s), self._noise_nm[number])
        if end_s <= stop_s:
            self._tick = end_tick

    def _swing(self, end_s: float, noise_nm: float) -> None:
        """Move on to `end_s` within a tick while the vibration changes."""
        vibration = self._stator.advance(end_s - self._now_s)
        self._grip = self._contact.grip(vibration)
        self._thermal.set_loss(self._now_s, self._thermal.loss_w(self._drive, vibration))
        self._rotor.advance(self._now_s, [(end_s, noise_nm)], self._grip)
        self._now_s = end_s
        if self._stator.settled:
            self._regrip()

    def _glide(self, end_tick: int, end_s: float, number: int) -> None:
        """Move on to `end_s` under a steady vibration; noise `number` is the first tick's."""
        ends_s = [end_s]
        if not self._rotor.stays(self._grip, self._noise_bound_nm):
            ends_s[:0] = [tick / TICKS_PER_S for tick in range(self._tick + 1, end_tick)]
        noise_nm = self._noise_nm[number : number + len(ends_s)]
        self._rotor.advance(self._now_s, zip(ends_s, noise_nm, strict=True), self._grip)
        self._now_s = end_s

    def _regrip(self) -> None:
        """Take over what the stator does now, after a command or a transient's end."""
        vibration = self._stator.vibration
        self._grip = self._contact.grip(vibration)
        self._thermal.set_loss(self._now_s, self._thermal.loss_w(self._drive, vibration))

    def _set_drive(self, drive: Drive) -> None:
        self._drive = drive
        self._stator.set_drive(drive)

    def _warm(self) -> None:
        """Carry the temperatures to now and move the resonances with them."""
        self._warm_tick = self._tick + _THERMAL_TICKS
        self._thermal.advance(self._now_s)
        self._stator.set_warming(self._thermal.warming_k)
        if self._stator.settled:
            self._regrip()

    def _state(self) -> _Mark:
        return _Mark(
            self._now_s,
            self._tick,
            len(self._rotor.path),
            self._rotor.state,
            self._stator.envelopes,
            self._grip,
            self._thermal.meter,
        )

    def _return_to(self, mark: _Mark) -> None:
        """Go back to the state before the last step."""
        self._now_s = mark.now_s
        self._tick = mark.tick
        del self._rotor.path[mark.pieces :]
        self._rotor.state = mark.rotor
        self._stator.envelopes = mark.envelopes
        self._grip = mark.grip
        self._thermal.meter = mark.heat
