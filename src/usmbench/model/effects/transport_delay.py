"""Commands act late."""

from collections.abc import Sequence

import numpy as np

from usmbench.model.effects.base import DEFINITION, Array, DynamicsEffect, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import later
from usmbench.model.effects.parameter import Parameter
from usmbench.model.hammerstein import LinearPart


class TransportDelay(DynamicsEffect):
    """A dead time d before everything: the line, the board, or the software holds a command back.

    As exact as `first_order.later`.
    """

    name = "transport_delay"
    form_off = DEFINITION
    meaning = "Commands act later than the simulation says."
    mend = "Time a command from the host to the generator's pins; look at the line's rate."
    parameters = (
        Parameter(
            "delay_s",
            "s",
            0.0,
            0.0,
            1.0,
            0.002,
            scanned=True,
            what="how much later than simulated a command acts",
        ),
    )

    def linear_part(self, linear: LinearPart, context: Context, values: Values) -> LinearPart:
        """Return the late linear part.

        Parameters
        ----------
        linear, context, values
            As in `DynamicsEffect.linear_part`.
        """
        return later(linear, values["delay_s"], context.window_s)

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return delays from a 500th of a window, which steps still show, to a hundred or a second.

        Parameters
        ----------
        contexts
            All stretches.
        """
        windows = np.r_[np.geomspace(0.002, 0.15, 12), np.linspace(0.2, 0.9, 8)]
        windows = np.r_[windows, np.arange(1.0, 13.0), np.geomspace(14.0, 100.0, 14)]
        return {"delay_s": np.unique(np.minimum(windows * contexts[0].window_s, 1.0))}

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why where the phase never moves.

        Parameters
        ----------
        contexts
            All stretches.
        """
        if any(np.ptp(c.phase_deg) > 0.0 for c in contexts):
            return None
        return "the phase never changes"


FORMS = (TransportDelay(),)
