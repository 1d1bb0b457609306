"""The generator sets φ on a coarse grid."""

from collections.abc import Sequence

import numpy as np

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values

_MEANING = "The generator sets the phase on a coarse grid instead of where it is commanded."
_MEND = "Read the generator's phase register back, and check how many of its bits are written."
_COARSEST_DEG = 60.0


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
        """Return the grids of a register with n values, and round numbers of degrees.

        Parameters
        ----------
        contexts
            All stretches.
        """
        register = 360.0 / 2.0 ** np.arange(3, 13)
        decimal = [0.1, 0.2, 0.25, 0.5, 1, 1.5, 1.8, 2, 2.5, 3, 3.6, 4, 5, 6, 7.2, 7.5, 8, 9, 10]
        coarse = [12, 15, 18, 20, 24, 30, 36, 40, 60]
        return {"step_deg": np.unique([*register, *decimal, *coarse])}


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
