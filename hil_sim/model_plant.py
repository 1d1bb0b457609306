"""A model file as the motor: identified, or extended by what a diagnosis found.

The motor turns as `usmbench replay` says, without noise. A command acts in the window in whose
last sample it is in force: that is what the rows the model was identified on say.
"""

import math
from collections import deque
from collections.abc import Callable
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from hil_sim.model_speed import ModelSpeed, Window
from hil_sim.plant.disc import Disc
from hil_sim.plant.parameters import DiscParameters
from hil_sim.plant.rotor import Piece, RotorState
from hil_sim.signals import Drive, Samples
from usmbench.model.hammerstein import HammersteinModel

_ROOM_C: Final = 25.0
_ROUNDING_S: Final = 1e-9


class ModelPlant:
    """A motor that does what a model says, with a disc on its shaft.

    Parameters
    ----------
    model
        The model; beyond the range it was identified on, its curve is held.
    disc
        The code wheel; the bench's where None.

    Raises
    ------
    usmbench.errors.InputError
        The model has no time step, or an effect that is not installed or fails.
    """

    def __init__(self, model: HammersteinModel, disc: DiscParameters | None = None):
        self._speed = ModelSpeed(model)
        self._disc = Disc(DiscParameters() if disc is None else disc)
        self._drive = Drive()
        self._torque_nm = 0.0
        self._waiting: deque[tuple[float, Callable[[], None]]] = deque()
        self._path: list[Piece] = [(0.0, 0, 0.0, 0.0, 0.0, 0.0)]
        self._next_window_s = self._origin_s = 0.0
        self._window_s = self._speed.window_s
        self._clock_start_s, self._clock_rate_hz, self._clock_samples = 0.0, 0.0, 0

    def drive(self, time_s: float, drive: Drive) -> None:
        """Change the drive voltages; see `hil_sim.signals.Plant`.

        Parameters
        ----------
        time_s
            When.
        drive
            The voltages; the motor knows them as on, with both above 0, or off.
        """

        def act() -> None:
            self._drive = drive

        self._waiting.append((time_s, act))

    def set_load(self, time_s: float, torque_nm: float) -> None:
        """Change the load torque; see `hil_sim.signals.Plant`.

        Parameters
        ----------
        time_s
            When.
        torque_nm
            Load torque, of account where the model has several.
        """

        def act() -> None:
            self._torque_nm = torque_nm

        self._waiting.append((time_s, act))

    def set_coupling(self, time_s: float, coupled: bool) -> None:
        """Join the disc to the shaft, or let it stand.

        Parameters
        ----------
        time_s
            When.
        coupled
            Whether it is joined.
        """
        self._waiting.append((time_s, lambda: self._disc.set_coupling(coupled, self._shaft())))

    def set_dead_channel(self, time_s: float, channel: Literal["a", "b"] | None) -> None:
        """Hold one encoder channel at its level, or neither.

        Parameters
        ----------
        time_s
            When.
        channel
            The channel.
        """
        self._waiting.append((time_s, lambda: self._disc.set_dead_channel(channel, self._shaft())))

    def sample(self, n_samples: int, sample_rate_hz: float) -> Samples:
        """Take the next samples; see `hil_sim.signals.Plant`.

        Parameters
        ----------
        n_samples
            How many.
        sample_rate_hz
            Rate of the sample clock; another rate than before starts a window.
        """
        times_s, end_s = self._clock(n_samples, sample_rate_hz)
        while self._next_window_s < end_s - _ROUNDING_S:
            self._follow_window(end_s)
        position, pulses = self._disc.read(times_s, self._path)
        while len(self._path) > 1 and self._path[1][0] <= times_s[-1]:
            del self._path[0]
        return Samples(position, pulses, _ROOM_C)

    def _clock(self, n_samples: int, sample_rate_hz: float) -> tuple[NDArray[np.float64], float]:
        """Return the times of the next samples, and that of the one after them."""
        if sample_rate_hz != self._clock_rate_hz:
            if self._clock_samples:
                self._clock_start_s += self._clock_samples / self._clock_rate_hz
            self._clock_rate_hz, self._clock_samples = sample_rate_hz, 0
            self._next_window_s = self._origin_s = self._clock_start_s
            # A model's windows are the mean of a record's, and so a little off whole samples.
            whole = max(round(self._speed.window_s * sample_rate_hz), 1)
            self._window_s = whole / sample_rate_hz
        ticks = np.arange(float(self._clock_samples), float(self._clock_samples + n_samples + 1))
        self._clock_samples += n_samples
        times_s = self._clock_start_s + ticks / sample_rate_hz
        return times_s[:-1], float(times_s[-1])

    def _follow_window(self, known_until_s: float) -> None:
        """Turn the shaft by another window, under the commands known by its end."""
        start_s, window_s = self._next_window_s, self._window_s
        number = round((start_s - self._origin_s) / window_s) + 1
        end_s = self._origin_s + number * window_s
        while self._waiting and self._waiting[0][0] < min(end_s, known_until_s) - _ROUNDING_S:
            self._waiting.popleft()[1]()
        drive = self._drive
        driven = drive.amplitude_a > 0.0 and drive.amplitude_b > 0.0
        window = Window(
            number * window_s, drive.phase_deg, drive.frequency_hz, self._torque_nm, driven
        )
        revolutions, angle_rad = self._angle_at(start_s)
        speed_rad_s = self._speed.speed_rad_s(window)
        self._path.append((start_s, revolutions, angle_rad, speed_rad_s, 0.0, 0.0))
        self._next_window_s = end_s

    def _angle_at(self, time_s: float) -> tuple[int, float]:
        """Whole turns and angle where the path stands at a time."""
        since_s, revolutions, angle_rad, speed_rad_s, _, _ = self._path[-1]
        angle_rad += speed_rad_s * (time_s - since_s)
        turns = math.floor(angle_rad / math.tau)
        return revolutions + turns, angle_rad - turns * math.tau

    def _shaft(self) -> RotorState:
        return RotorState(self._path[-1][3], *self._angle_at(self._next_window_s))
