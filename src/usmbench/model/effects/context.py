"""What an effect may know of the run that it acts on."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.model.driving import ALWAYS, Driving
from usmbench.model.hammerstein import LinearPart
from usmbench.model.lagged import lagged

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Context:
    """What an effect may know of an unbroken stretch of a run; columns have shape (N,).

    Parameters
    ----------
    t_s
        End of each window, from the first sample of the run.
    window_s
        Duration of a window.
    phase_deg
        Commanded phase; at the stage `settled` the one that is set, with what effects of the stage
        `command` make of it, but for the steps of a grid.
    settled_rad_s
        The model's static curve at this stretch's operating points: phases in, speeds out.
    linear
        The model's linear part.
    angle_rad
        Shaft angle by the counter at the middle of each window; None where only the simulation
        itself can say.
    detuning_rad_s
        How the settled speed changes with the drive frequency, relative to it: f ∂v/∂f, phases in;
        None where the model knows one frequency only.
    count_rad_s
        One count in a window; None where the run does not say how many a revolution has.
    phase_step_deg
        Step of the phases that the generator sets; None where the run does not say.
    driving
        When in the run the motor was driven, and warmed.
    """

    t_s: Array
    window_s: float
    phase_deg: Array
    settled_rad_s: Callable[[Array], Array]
    linear: LinearPart
    angle_rad: Array | None = None
    detuning_rad_s: Callable[[Array], Array] | None = None
    count_rad_s: float | None = None
    phase_step_deg: float | None = None
    driving: Driving = ALWAYS

    @property
    def n(self) -> int:
        """Number of windows."""
        return self.t_s.size

    @property
    def driven(self) -> Array:
        """Share of each window in which the motor was driven, shape (N,)."""
        return self.driving.share_at(self.t_s)

    def turned_rad(self, speed_rad_s: Array) -> Array:
        """Return the shaft's angle in the middle of each window, shape (N,).

        Parameters
        ----------
        speed_rad_s
            Its speed, shape (N,), which is added up where no counter says the angle.
        """
        if self.angle_rad is None:
            return middle_rad(speed_rad_s, self.window_s)
        return self.angle_rad

    def moved_rad_s(self, phase_deg: Array) -> Array:
        """Return what the settled speed gains at other phases than those commanded, shape (N,).

        Parameters
        ----------
        phase_deg
            The other phases, shape (N,).
        """
        return self.settled_rad_s(phase_deg) - self.settled_rad_s(self.phase_deg)

    def warmed(self, constant_s: float) -> Array:
        """Return how warm the run has made the motor, as a share of the most, shape (N,).

        Parameters
        ----------
        constant_s
            Time constant of the warming.
        """
        return self.driving.warmed(self.t_s, constant_s)

    def behind(self, heating: Array, constant_s: float) -> Array:
        """Return what heats the motor, behind a first-order lag, cold as the run began, shape (N,).

        Before the stretch, of which nothing is known here, it is what it is in the mean.

        Parameters
        ----------
        heating
            What heats it in each window, in any unit, shape (N,).
        constant_s
            Time constant of the lag.
        """
        before_s = np.maximum(self.t_s[:1] - self.window_s, 0.0)
        before = np.mean(heating) * self.driving.warmed(before_s, constant_s)
        return lagged(heating, np.exp(-self.window_s / constant_s), float(before[0]))


def longest_s(contexts: Sequence[Context]) -> float:
    """Return for how long the longest run drives the motor, in seconds.

    Parameters
    ----------
    contexts
        Stretches, at least one.
    """
    return max(float(c.driving.driven_s(c.t_s[-1:])[0]) for c in contexts)


def highest_settled_rad_s(contexts: Sequence[Context]) -> float:
    """Return the highest settled speed, either way, that the commands of all runs ask for.

    Parameters
    ----------
    contexts
        Stretches, at least one.
    """
    return max(float(np.max(np.abs(c.settled_rad_s(c.phase_deg)))) for c in contexts)


def middle_rad(speed_rad_s: Array, window_s: Array | float) -> Array:
    """Return the angle turned from the start to the middle of each window, shape (N,).

    Parameters
    ----------
    speed_rad_s
        Mean speed of each window, shape (N,).
    window_s
        Duration of a window, or of each, shape (N,).
    """
    turned_rad = speed_rad_s * window_s
    middle: Array = np.cumsum(turned_rad) - 0.5 * turned_rad
    return middle
