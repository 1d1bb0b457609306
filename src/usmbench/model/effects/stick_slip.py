"""Friction that is strongest at low speed."""

from collections.abc import Sequence

import numpy as np

from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context, highest_settled_rad_s
from usmbench.model.effects.later_start import WIDER
from usmbench.model.effects.parameter import Parameter


class StickSlip(Effect):
    """v′ = v − l exp(−|v|/v_s) sign v, and 0 where that would turn round: a falling friction.

    Stribeck's curve, as the window's average over sticking and slipping sees it.
    """

    name = "stick_slip"
    meaning = "At low speed the shaft sticks and slips; at high speed it runs as before."
    mend = "Look for a dry or dirty bearing or seal; listen at low speed."
    stage = "settled"
    parameters = (
        Parameter(
            "lost_rad_s",
            "rad/s",
            0.0,
            0.0,
            10.0,
            0.05,
            what="speed that friction takes near standstill",
        ),
        Parameter(
            "fades_rad_s",
            "rad/s",
            1.0,
            0.02,
            5.0,
            0.3,
            scanned=True,
            what="speed over which that falls to 1/e",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        size = np.abs(signal)
        lost = values["lost_rad_s"] * np.exp(-size / values["fades_rad_s"])
        return np.sign(signal) * np.maximum(size - lost, 0.0)

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return speeds within the lower half of the curve.

        Parameters
        ----------
        contexts
            All stretches.
        """
        fades_rad_s = highest_settled_rad_s(contexts) * np.geomspace(0.01, 0.4, 8)
        return {"fades_rad_s": np.clip(fades_rad_s, 0.02, 5.0)}

    @property
    def lookalikes(self) -> tuple[Effect, ...]:
        """Dead zones that are wider: a curve drawn through may end elsewhere, or cannot jump."""
        return WIDER

    def habitual(self, contexts: Sequence[Context]) -> bool:
        """Return True: a smooth curve rounds off where a healthy motor stands still.

        Parameters
        ----------
        contexts
            All stretches.
        """
        return True


FORMS = (StickSlip(),)
