"""Stator, contact, rotor and heat moved on together, on a fixed grid of ticks.

A command that falls inside a tick splits it; where the motion was already followed beyond the
command, that tick is done again up to it. Every tick's noise is addressed by the tick's number. So
neither the size of the blocks nor the sample rate changes the motion.
"""

from typing import NamedTuple

import numpy as np

from hil_sim.plant.contact import Contact, Grip
from hil_sim.plant.noise import BLOCK, TorqueNoise
from hil_sim.plant.parameters import PlantParameters
from hil_sim.plant.rotor import Piece, Rotor, RotorState, ShaftLoad
from hil_sim.plant.stator import Stator
from hil_sim.plant.thermal import HeatMeter, Thermal
from hil_sim.signals import Drive

TICKS_PER_S = 1000
"""Ticks a second, fine against the rotor's 3 ms and the noise's correlation time."""

# Divides a block of noise, so that a step never needs two.
_THERMAL_TICKS = 128
# Standard deviations that the noise passes once in 10¹⁵ ticks.
_NOISE_BOUND = 8.0
# The envelopes' 0.5 ms need finer steps: parts of a tick while their transient is larger than the
# given size (relative to resonance), and parts until it is over.
_FAST_RESIDUE = 0.03
_FAST_PARTS = 8
_SLOW_PARTS = 2
# Keeps a rest from ending beyond a command through rounding, in ticks.
_TICK_ROUNDING = 1e-4


class _Mark(NamedTuple):
    """State before the last step, to which a command inside it returns."""

    now_s: float
    tick: int
    pieces: int
    rotor: RotorState
    envelopes: tuple[complex, complex]
    grip: Grip
    heat: HeatMeter


class Motion:
    """The motor from its drive to the path of its shaft.

    Parameters
    ----------
    parameters
        The motor.
    seed
        Seed of the torque noise.
    load
        What else hangs on the shaft, or None.
    """

    def __init__(self, parameters: PlantParameters, seed: int, load: ShaftLoad | None = None):
        p = parameters
        self._stator = Stator(p.stator)
        self._contact = Contact(p.contact)
        self._rotor = Rotor(p.rotor, load)
        self._thermal = Thermal(p.thermal, _THERMAL_TICKS / TICKS_PER_S)
        self._noise = TorqueNoise(
            seed, p.rotor.noise_nm, p.rotor.noise_correlation_s, 1.0 / TICKS_PER_S
        )
        self._noise_block = -1
        self._noise_nm: list[float] = []
        self._noise_bound_nm = _NOISE_BOUND * p.rotor.noise_nm
        self._drive = Drive()
        self._now_s = 0.0
        self._tick, self._warm_tick = 0, _THERMAL_TICKS
        self._grip = self._contact.grip(self._stator.vibration)
        self._mark = self._state()

    @property
    def shaft(self) -> RotorState:
        """The shaft where the motion stands."""
        return self._rotor.state

    @property
    def path(self) -> list[Piece]:
        """The shaft's path from the last time forgotten on."""
        return self._rotor.path

    @property
    def temperature_c(self) -> float:
        """Stator temperature."""
        return self._thermal.temperature_c

    def set_drive(self, drive: Drive) -> None:
        """Change the drive where the motion stands.

        Parameters
        ----------
        drive
            The voltages.
        """
        self._drive = drive
        self._stator.set_drive(drive)
        self._regrip()

    def set_brake(self, torque_nm: float) -> None:
        """Change the load against any motion where the motion stands.

        Parameters
        ----------
        torque_nm
            Torque of the brake, at least 0.
        """
        self._rotor.set_brake(torque_nm)

    def follow_past(self, time_s: float) -> None:
        """Follow the motion until its path covers a time.

        Parameters
        ----------
        time_s
            Simulated time.
        """
        while self._now_s <= time_s:
            self._step(time_s, np.inf)

    def follow_to(self, time_s: float) -> None:
        """Follow the motion to exactly this time, for a command; may go back within a tick.

        Parameters
        ----------
        time_s
            Simulated time, not before the last one that `forget_before` was given.
        """
        if time_s < self._now_s:
            self._return_to(self._mark)
        while self._now_s < time_s:
            self._step(time_s, time_s)

    def forget_before(self, time_s: float) -> None:
        """Drop what the path holds before a time.

        Parameters
        ----------
        time_s
            Simulated time that the path covers.
        """
        path = self._rotor.path
        gone = len(path) - 1
        while path[gone][0] > time_s:
            gone -= 1
        del path[:gone]
        self._mark = self._mark._replace(pieces=max(0, self._mark.pieces - gone))

    def _step(self, until_s: float, stop_s: float) -> None:
        """Integrate some ticks towards `until_s`, the last one only as far as `stop_s`."""
        if self._tick >= self._warm_tick:
            self._warm()
        end_tick = self._tick + 1
        gliding = self._stator.settled
        if gliding:
            whole = int(until_s * TICKS_PER_S - _TICK_ROUNDING)
            end_tick = max(end_tick, min(whole, self._warm_tick))
        end_s = end_tick / TICKS_PER_S
        if end_s > until_s:
            self._mark = self._state()
        if gliding:
            self._glide(end_tick, min(end_s, stop_s))
        else:
            self._swing(min(end_s, stop_s))
        if end_s <= stop_s:
            self._tick = end_tick

    def _swing(self, end_s: float) -> None:
        """Move on to `end_s` within a tick, in parts, while the vibration changes."""
        (noise_nm,) = self._noise_of(1)
        parts = _FAST_PARTS if self._stator.residue > _FAST_RESIDUE else _SLOW_PARTS
        for part in range(self._tick * parts + 1, (self._tick + 1) * parts + 1):
            part_end_s = min(part / (parts * TICKS_PER_S), end_s)
            if part_end_s <= self._now_s:
                continue
            vibration = self._stator.advance(part_end_s - self._now_s)
            self._grip = self._contact.grip(vibration)
            self._thermal.set_loss(self._now_s, self._thermal.loss_w(self._drive, vibration))
            self._rotor.advance(self._now_s, ((part_end_s, noise_nm),), self._grip)
            self._now_s = part_end_s
        if self._stator.settled:
            self._regrip()

    def _glide(self, end_tick: int, end_s: float) -> None:
        """Move on to `end_s`, in the tick before `end_tick`, under a steady vibration."""
        if self._rotor.stays(self._grip, self._noise_bound_nm):
            steps = [(end_s, 0.0)]
        else:
            ends_s = [tick / TICKS_PER_S for tick in range(self._tick + 1, end_tick)]
            ends_s.append(end_s)
            steps = list(zip(ends_s, self._noise_of(len(ends_s)), strict=True))
        self._rotor.advance(self._now_s, steps, self._grip)
        self._now_s = end_s

    def _noise_of(self, n_ticks: int) -> list[float]:
        """Torque noise of the next ticks, none of which is beyond the next warming."""
        block, number = divmod(self._tick, BLOCK)
        if block != self._noise_block:
            self._noise_block, self._noise_nm = block, self._noise.block(block)
        return self._noise_nm[number : number + n_ticks]

    def _regrip(self) -> None:
        """Take over what the stator does now, after a command or a transient's end."""
        vibration = self._stator.vibration
        self._grip = self._contact.grip(vibration)
        self._thermal.set_loss(self._now_s, self._thermal.loss_w(self._drive, vibration))

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
