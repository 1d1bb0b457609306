"""The generator sets φ on a coarse grid."""

from bisect import bisect
from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from usmbench.model.effects.base import DEFINITION, Array, Effect, Mask, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.parameter import Parameter

_MEANING = "The generator sets the phase on a coarse grid instead of where it is commanded."
_MEND = "Read the generator's phase register back, and check how many of its bits are written."
_COARSEST_DEG = 60.0
_FINEST_DEG, _ALWAYS_DEG, _COARSE_DEG = 0.35, 0.7, 10.0
_LONG = 20_000  # windows, where finer steps would take a third more time
# That a step is worth at least: whole counts look like steps of one. Nothing measured sets it.
_COUNTS = 1.5
_MANY = 50  # phases: twice the levels of a fine staircase
# Phases of a staircase, and what neighbours differ by over what those far apart do: 0 of a smooth
# shape, 1 of chance. Nothing measured sets them.
_LEVELS, _UNEVEN = 20, 0.8
_MEANT = 1e-3  # of a usual step: nearer than that nobody builds another
_SAME_STEP = 1e-9  # a commanded multiple must not fall below itself by rounding
_FARTHEST, _ALIKE = 2.0, 1600  # times a step; how many steps in between. Nothing measured sets them
# Registers with n values, and round numbers of degrees.
_USUAL_DEG = sorted(
    {
        *(360.0 / 2.0**n for n in range(3, 13)),
        *(0.1, 0.2, 0.25, 0.5, 1, 1.5, 1.8, 2, 2.5, 3, 3.6, 4, 5, 6, 7.2, 7.5, 8, 9, 10),
        *(12, 15, 18, 20, 24, 30, 36, 40, 60),
    }
)


def _exact_deg(step_deg: float) -> float:
    """Return the usual step that is meant: phases on one grid must stay on a multiple of it."""
    at = bisect(_USUAL_DEG, step_deg)
    beside_deg = _USUAL_DEG[max(at - 1, 0) : at + 1]
    nearest_deg = min(beside_deg, key=lambda usual: abs(usual - step_deg))
    return nearest_deg if abs(step_deg - nearest_deg) < _MEANT * nearest_deg else step_deg


def _many_phases(contexts: Sequence[Context]) -> bool:
    """Whether there are more phases than levels of a staircase."""
    return max(np.unique(c.phase_deg).size for c in contexts) >= _MANY


def _told_apart(step_deg: Array, contexts: Sequence[Context]) -> Mask:
    """Which steps no smooth shape stands in for, where phases are few.

    These are steps coarser than the phases lie apart, and, of a staircase's levels, those that move
    each otherwise than its neighbours.
    """
    phase_deg = np.unique(np.concatenate([c.phase_deg for c in contexts]))
    if phase_deg.size < 2:
        return np.zeros(step_deg.size, dtype=np.bool_)
    coarse: Mask = step_deg >= np.median(np.diff(phase_deg))
    if phase_deg.size < _LEVELS:
        return coarse
    steps = phase_deg / step_deg[:, None]
    moved = steps - np.rint(steps)
    beside = np.mean(np.diff(moved) ** 2, axis=1)
    uneven: Mask = beside > 2.0 * _UNEVEN * np.var(moved, axis=1)
    return coarse | uneven


def _told_from_counts_deg(context: Context) -> float:
    """Least step that is not lost among whole counts of the encoder; 0 where these are unknown."""
    if context.count_rad_s is None:
        return 0.0
    ahead, behind = (context.settled_rad_s(context.phase_deg + x) for x in (0.5, -0.5))
    steepest = float(np.max(np.abs(ahead - behind)))
    return _COUNTS * context.count_rad_s / max(steepest, 1e-9)


class RoundedPhase(Effect):
    """φ′ = q round(φ/q), halves to the even neighbour: the register's low bits are missing."""

    name = "phase_quantisation"
    form = "rounded"
    meaning = _MEANING
    mend = _MEND
    stage = "command"
    form_off = DEFINITION
    jagged = True
    early = True  # in the register: what shifts the drive voltages does so behind it
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "step_deg", "deg", 0.0, 0.0, _COARSEST_DEG, 1.0, scanned=True, what="step of the grid"
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the phase on the grid.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        step_deg = _exact_deg(values["step_deg"])
        return signal if step_deg <= 0.0 else step_deg * self._whole(signal / step_deg)

    def _whole(self, steps: Array) -> Array:
        return np.asarray(np.rint(steps))

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return usual steps, and all others that the phases tell apart.

        Between two neighbours no phase then moves by more than half a step, nor by a quarter of a
        coarse one, which leaves few levels to tell it by. Where phases are few, some steps finer
        than they lie apart bend them into a smooth shape: of these only usual ones are tried. So it
        is below a third of a degree everywhere, below 0.7 in long runs, and where a step is worth
        no more than a count: whole counts make such ripples themselves.

        Parameters
        ----------
        contexts
            All stretches.
        """
        farthest_deg = max(float(np.max(np.abs(c.phase_deg))) for c in contexts)
        long = sum(c.n for c in contexts) > _LONG
        least_deg = np.inf if long else max(map(_told_from_counts_deg, contexts))
        finest_deg = float(np.clip(least_deg, _FINEST_DEG, _ALWAYS_DEG))
        fine = np.arange(1.0, farthest_deg / finest_deg, 0.5)
        coarse = np.arange(1.0, farthest_deg / _COARSE_DEG, 0.25)
        free = farthest_deg / np.r_[fine, coarse]
        if not _many_phases(contexts):
            free = free[_told_apart(free, contexts)]
        tried = np.unique([*_USUAL_DEG, *free])
        return {"step_deg": tried[tried <= _COARSEST_DEG]}

    def alike(self, values: Values, contexts: Sequence[Context]) -> tuple[Array, Mask]:
        """Return steps from half of one to twice as much, where phases are few.

        Parameters
        ----------
        values, contexts
            As in `Effect.alike`.
        """
        if _many_phases(contexts):
            return super().alike(values, contexts)
        steps_deg = values["step_deg"] * np.geomspace(1.0 / _FARTHEST, _FARTHEST, _ALIKE)
        steps_deg = steps_deg[steps_deg <= _COARSEST_DEG]
        return steps_deg, _told_apart(steps_deg, contexts)

    def built_in(self, contexts: Sequence[Context]) -> dict[str, float] | None:
        """Return the generator's own step, where all runs say one and the same.

        Parameters
        ----------
        contexts
            All stretches.
        """
        steps = {c.phase_step_deg for c in contexts}
        step_deg = steps.pop()
        return None if steps or step_deg is None else {"step_deg": step_deg}

    def habitual(self, contexts: Sequence[Context]) -> bool:
        """Return whether there are phases enough to tell the step.

        Parameters
        ----------
        contexts
            All stretches.
        """
        return _many_phases(contexts)


class RoundedUpPhase(RoundedPhase):
    """φ′ = q ⌊φ/q + ½⌋: halves go up, as where half a step is added before the bits are cut."""

    form = "rounded up"

    def _whole(self, steps: Array) -> Array:
        return np.asarray(np.floor(steps + 0.5))

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why where a run has so many phases that hardly any is a half.

        Parameters
        ----------
        contexts
            All stretches.
        """
        return (
            "hardly any phase lies half way between two steps" if _many_phases(contexts) else None
        )


class TruncatedPhase(RoundedPhase):
    """φ′ = q ⌊φ/q⌋: the low bits are cut off."""

    form = "cut off"

    def _whole(self, steps: Array) -> Array:
        return np.asarray(np.floor(steps + _SAME_STEP))


class PhaseCutToZero(RoundedPhase):
    """φ′ = ±q ⌊|φ|/q⌋: a number with a sign is cut to a whole one, as by a cast in C."""

    form = "cut to zero"

    def _whole(self, steps: Array) -> Array:
        return np.asarray(np.trunc(steps + np.copysign(_SAME_STEP, steps)))


FORMS = (RoundedPhase(), RoundedUpPhase(), TruncatedPhase(), PhaseCutToZero())
