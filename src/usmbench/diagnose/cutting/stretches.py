"""Unbroken stretches of runs, each with what the effects and the noise need to know."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.model.effects.context import Context

Array = NDArray[np.float64]

_FASTEST_RAD_S = 1e3  # beyond any step
Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Stretch:
    """Consecutive windows of one run; columns have shape (N,).

    Parameters
    ----------
    run
        Index of the run.
    name
        Its name.
    context
        What effects may know.
    speed_rad_s
        Measured speed.
    simulated_rad_s
        Free run of the model as given.
    settled_rad_s
        Its settled speed.
    lag
        Windows since the phase last changed.
    step_rad_s
        Change of the settled speed at that moment.
    direction
        +1 where φ last rose, -1 where it last fell, 0 before it moved.
    jump
        Number of the last jump and the windows since: the same on rows that repeat each other.
    use
        Rows to judge: inside the model's range and past the start.
    points
        Weight of each of the model's operating points.
    places
        Place among them in frequency and torque, as far as they differ, from -1 to 1.
    warmth
        How warm the run has made the motor, by `warmth`: by being driven at all (no unit), by the
        speed whatever its direction (rad/s), and by the square of the highest speed at each row's
        operating point (rad²/s²), shape (3, T, N).
    moment_rad_s
        What the speed may be off by where nobody knows when a command acted, or 0.
    scatter_rad_s
        Standard deviation of what the model's own effects do by chance, or 0.
    doubt_rad_s
        What the model's own effects may be off by, in columns of one standard deviation, shape
        (N, D); None for a model without effects.
    unsure_warmth
        What it may be more or less by, where nobody knows whether the motor was driven in a gap;
        None without one.
    start
        How often the motor has stood in a pause before: it then starts as on another day.
    """

    run: int
    name: str
    context: Context
    speed_rad_s: Array
    simulated_rad_s: Array
    settled_rad_s: Array
    lag: NDArray[np.int64]
    step_rad_s: Array
    direction: Array
    jump: NDArray[np.int64]
    use: Mask
    points: tuple[Array, ...]
    places: tuple[Array, ...]
    warmth: Array
    moment_rad_s: Array | float = 0.0
    scatter_rad_s: Array | float = 0.0
    doubt_rad_s: Array | None = None
    unsure_warmth: Array | None = None
    start: int = 0

    @property
    def again(self) -> NDArray[np.int64]:
        """How many rows repeat each one, itself among them, shape (N,)."""
        counts: NDArray[np.int64] = np.bincount(self.jump)[self.jump]
        return counts

    @property
    def residual_rad_s(self) -> Array:
        """Measured less simulated speed."""
        return self.speed_rad_s - self.simulated_rad_s


def stepped(values: Array, begins: NDArray[np.int64]) -> Array:
    """Return by how much values changed when each row's dwell began, in their unit, shape (N,).

    Parameters
    ----------
    values
        The values, shape (N,).
    begins
        The row at which each one's dwell began, shape (N,).
    """
    return np.diff(values, prepend=values[:1])[begins]


def came_from(
    settled_rad_s: Array, step_rad_s: Array, lag: NDArray[np.int64]
) -> NDArray[np.complex128]:
    """Return what came before each row, as one value; a plan that repeats it errs the same way.

    Parameters
    ----------
    settled_rad_s, step_rad_s, lag
        As a `Stretch` has them, shape (N,).
    """
    # One complex value sorts many times as fast as rows of three numbers.
    return np.round(settled_rad_s + 1j * (step_rad_s + _FASTEST_RAD_S * lag), 6)


def first_windows(stretches: Sequence[Stretch], most: int) -> list[Stretch]:
    """Return stretches in order, as far as a number of windows holds them; the first always.

    Parameters
    ----------
    stretches
        The stretches, at least one.
    most
        Windows at most, unless the first has more.
    """
    kept = [stretches[0]]
    for stretch in stretches[1:]:
        if sum(s.context.n for s in kept) + stretch.context.n <= most:
            kept.append(stretch)
    return kept
