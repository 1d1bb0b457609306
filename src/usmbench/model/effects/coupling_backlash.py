"""Play in the coupling between motor and disc."""

from collections.abc import Sequence

import numpy as np

from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.parameter import Parameter
from usmbench.model.effects.play import passed_on
from usmbench.model.linear import delayed


class CouplingBacklash(Effect):
    """After a reversal the disc stands until the rotor has turned through the gap."""

    name = "coupling_backlash"
    meaning = "The coupling has play: after each reversal the disc waits for the rotor."
    mend = "Hold the disc and turn the rotor to and fro by hand; tighten the coupling's screws."
    stage = "motion"
    parameters = (
        Parameter(
            "gap_rad",
            "rad",
            0.0,
            0.0,
            1.0,
            0.01,
            scanned=True,
            what="whole angle between the two flanks",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the disc's speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        gap_rad = values["gap_rad"]
        if gap_rad <= 0.0:
            return signal
        moves_rad = passed_on(_moves_rad(signal, context), gap_rad)
        carried: Array = moves_rad.reshape(-1, 2).sum(axis=1) / context.window_s
        return carried

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return gaps from a part of a count of the disc to a sixth of a turn.

        Parameters
        ----------
        contexts
            All stretches.
        """
        return {"gap_rad": np.geomspace(1e-4, 1.0, 32)}

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why where the shaft never reverses.

        Parameters
        ----------
        contexts
            All stretches.
        """
        speeds = [c.settled_rad_s(c.phase_deg) for c in contexts]
        if any(float(v.min()) < 0.0 < float(v.max()) for v in speeds):
            return None
        return "the shaft never reverses"


def _moves_rad(shaft_rad_s: Array, context: Context) -> Array:
    """Return the shaft's moves in either part of each window, shape (2 N,).

    A shaft that is to reverse does so within the window of the command: the mean speed is that of
    a part at the old speed and a part at the new one.
    """
    after = context.settled_rad_s(context.phase_deg)
    before = delayed(after, 1, after[0])
    reverses = before * after < 0.0
    share = (shaft_rad_s - after) / np.where(reverses, before - after, 1.0)
    reverses &= (share > 0.0) & (share < 1.0)
    first = np.where(reverses, share * before, shaft_rad_s)
    return np.column_stack((first, shaft_rad_s - first)).ravel() * context.window_s


FORMS = (CouplingBacklash(),)
