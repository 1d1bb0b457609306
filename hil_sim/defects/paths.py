"""The wires on both sides of the motor: from the generators to it, from the disc to the counter."""

import heapq
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

from hil_sim.signals import Drive, Samples
from hil_sim.testbed import FaultablePlant


@dataclass(frozen=True, slots=True)
class DrivePath:
    """What happens to the drive voltages between generators and stator.

    Parameters
    ----------
    formed
        Returns what reaches the stator, at a time in s, of what the generators give.
    delay_s
        How late a change arrives.
    renew_s
        Period after which the voltages have to be formed again though no command came; infinite
        where they stay.
    in_register
        Whether it happens within a generator's register, and so before all else.
    """

    formed: Callable[[float, Drive], Drive]
    delay_s: float = 0.0
    renew_s: float = math.inf
    in_register: bool = False


class CountPath(Protocol):
    """What happens to the edges between disc and counter; called block after block."""

    def passed(self, samples: Samples, sample_rate_hz: float) -> Samples:
        """Return what the counter sees of what the disc shows."""


class WiredPlant:
    """A plant behind bad wires; a plant like any other.

    Parameters
    ----------
    plant
        Motor, shaft, disc.
    drive_paths
        From the generators on, in this order, registers first.
    count_paths
        From the disc on, in this order.
    """

    def __init__(
        self,
        plant: FaultablePlant,
        drive_paths: Sequence[DrivePath] = (),
        count_paths: Sequence[CountPath] = (),
    ):
        self._plant = plant
        self._drive_paths = tuple(sorted(drive_paths, key=lambda path: not path.in_register))
        self._count_paths = tuple(count_paths)
        self._delay_s = sum(path.delay_s for path in drive_paths)
        self._renew_s = min((path.renew_s for path in drive_paths), default=math.inf)
        self._renewal_s = self._renew_s
        self._drive = Drive()
        self._reached = Drive()
        self._time_s = 0.0
        self._waiting: list[tuple[float, int, Callable[[float], None]]] = []
        self._order = itertools.count()

    def drive(self, time_s: float, drive: Drive) -> None:
        """Change the drive voltages; see `hil_sim.signals.Plant`.

        Parameters
        ----------
        time_s
            When.
        drive
            What the generators give.
        """

        def act(now_s: float) -> None:
            self._drive = drive
            self._form(now_s)

        self._at(time_s + self._delay_s, act)

    def set_load(self, time_s: float, torque_nm: float) -> None:
        """Change the load torque; see `hil_sim.signals.Plant`.

        Parameters
        ----------
        time_s
            When.
        torque_nm
            Load torque.
        """
        self._at(time_s, lambda now_s: self._plant.set_load(now_s, torque_nm))

    def set_coupling(self, time_s: float, coupled: bool) -> None:
        """Join the encoder to the shaft, or let it slip.

        Parameters
        ----------
        time_s
            When.
        coupled
            Whether it is joined.
        """
        self._at(time_s, lambda now_s: self._plant.set_coupling(now_s, coupled))

    def set_dead_channel(self, time_s: float, channel: Literal["a", "b"] | None) -> None:
        """Hold one encoder channel at its level, or neither.

        Parameters
        ----------
        time_s
            When.
        channel
            The channel.
        """
        self._at(time_s, lambda now_s: self._plant.set_dead_channel(now_s, channel))

    def sample(self, n_samples: int, sample_rate_hz: float) -> Samples:
        """Take the next samples; see `hil_sim.signals.Plant`.

        Parameters
        ----------
        n_samples
            How many.
        sample_rate_hz
            Rate of the sample clock.
        """
        self._time_s += n_samples / sample_rate_hz
        self._act_until(self._time_s)
        samples = self._plant.sample(n_samples, sample_rate_hz)
        for path in self._count_paths:
            samples = path.passed(samples, sample_rate_hz)
        return samples

    def _at(self, time_s: float, act: Callable[[float], None]) -> None:
        heapq.heappush(self._waiting, (time_s, next(self._order), act))

    def _act_until(self, end_s: float) -> None:
        """Carry out what has become due, in the order of its time."""
        while True:
            next_s = self._waiting[0][0] if self._waiting else math.inf
            if min(next_s, self._renewal_s) >= end_s:
                return
            if next_s <= self._renewal_s:
                _, _, act = heapq.heappop(self._waiting)
                act(next_s)
            else:
                self._form(self._renewal_s)
                self._renewal_s += self._renew_s

    def _form(self, now_s: float) -> None:
        """Let the stator have what the generators' voltages have become on the way."""
        formed = self._drive
        for path in self._drive_paths:
            formed = path.formed(now_s, formed)
        if formed != self._reached:
            self._reached = formed
            self._plant.drive(now_s, formed)
