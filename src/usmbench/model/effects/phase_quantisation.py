"""The generator sets φ on a coarse grid."""

from collections.abc import Sequence

import numpy as np

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values

_MEANING = "The generator sets the phase on a coarse grid instead of where it is commanded."
_MEND = "Read the generator's phase register back, and check how many of its bits are written."
_FINEST_DEG, _COARSEST_DEG = 0.35, 60.0


class RoundedPhase(Effect):
    """φ′ = q round(φ/q): the register's low bits are missing and the value is rounded."""

    name = "phase_quantisation"
    form = "rounded"
    meaning = _MEANING
    mend = _MEND
    stage = "command"
    parameters = (Parameter("step_deg", "deg", 0.0, 0.0, _COARSEST_DEG, 1.0, scanned=True),)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the phase on the grid.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        step_deg = values["step_deg"]
        if step_deg <= 0.0:
            return signal
        return step_deg * np.floor(signal / step_deg + 0.5)

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return steps so close that the farthest phase moves by at most a third of a step.

        Parameters
        ----------
        contexts
            All stretches.
        """
        reach_deg = max(float(np.max(np.abs(c.phase_deg))) for c in contexts)
        # 360/n are the grids of a register with n values, tried exactly.
        steps = [360.0 / n for n in range(6, 1030)]
        step_deg = _FINEST_DEG
        while step_deg < _COARSEST_DEG:
            steps.append(step_deg)
            step_deg *= 1.0 + step_deg / (3.0 * max(reach_deg, step_deg))
        return {"step_deg": np.unique(steps)}


class TruncatedPhase(RoundedPhase):
    """φ′ = q ⌊φ/q⌋: the low bits are cut off."""

    form = "cut off"

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the phase on the grid below.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        step_deg = values["step_deg"]
        if step_deg <= 0.0:
            return signal
        return step_deg * np.floor(signal / step_deg + 1e-9)


FORMS = (RoundedPhase(), TruncatedPhase())
