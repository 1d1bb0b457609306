"""It starts later than it stops."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.parameter import Parameter
from usmbench.model.effects.play import last_way, passed_on
from usmbench.model.effects.sticking import (
    MEANING,
    MEND,
    AtRest,
    Backwards,
    EachWay,
    Forwards,
    Sticking,
)


class DirectedEdges(Effect):
    """Both edges shift by h with the direction of the last move: v′ = v(φ ∓ h/2)."""

    name = "dead_zone_hysteresis"
    form = "directed edges"
    meaning = MEANING
    mend = MEND
    stage = "settled"
    parameters = (
        Parameter(
            "width_deg",
            "deg",
            0.0,
            0.0,
            60.0,
            0.5,
            what="width of the loop: half of it farther out outward bound, half nearer in inward",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed: the dead zone is wider outward bound and narrower inward.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        outward = last_way(np.diff(np.abs(context.phase_deg), prepend=0.0))
        farther_deg = values["width_deg"] * self.share(outward)
        shift_deg = farther_deg * np.sign(context.phase_deg)
        return signal + context.moved_rad_s(context.phase_deg - shift_deg)

    def share(self, outward: Array) -> Array:
        """Return how much of the width the edges are farther out, shape (N,).

        Parameters
        ----------
        outward
            +1 where the phase last moved away from 0, -1 where towards it, shape (N,).
        """
        return 0.5 * outward


class OutwardEdges(DirectedEdges):
    """The edges are farther out outward bound, and where they were inward: v′ = v(φ − h) or v(φ).

    It starts later, and stops where it did.
    """

    form = "edges outward bound"
    parameters = (
        replace(DirectedEdges.parameters[0], what="how much farther out they are outward bound"),
    )

    def share(self, outward: Array) -> Array:
        """Return how much of the width the edges are farther out, shape (N,).

        Parameters
        ----------
        outward
            As in `DirectedEdges.share`.
        """
        return np.where(outward > 0.0, 1.0, 0.0)


class Play(Effect):
    """v′ = v(p), where p follows φ only after it has crossed a gap of h: it lags on either way."""

    name = "dead_zone_hysteresis"
    form = "play"
    meaning = MEANING
    mend = MEND
    stage = "settled"
    parameters = (
        Parameter(
            "width_deg",
            "deg",
            0.0,
            0.0,
            60.0,
            1.0,
            scanned=True,
            what="how far φ has to turn back before the motor follows",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed at the phases that have crossed the gap.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        moves_deg, width_deg = np.diff(context.phase_deg), values["width_deg"]
        if width_deg <= 0.0 or not np.any(moves_deg):
            return signal
        # Where it began is not known: at the flank of its first move.
        begin_deg = context.phase_deg[0] - 0.5 * width_deg * np.sign(moves_deg[moves_deg != 0.0][0])
        passed_deg = np.cumsum(passed_on(moves_deg, width_deg))
        behind_deg = begin_deg + np.concatenate(([0.0], passed_deg))
        return signal + context.moved_rad_s(behind_deg)

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return widths from a fiftieth of a degree to that of a wide dead zone.

        Parameters
        ----------
        contexts
            All stretches.
        """
        return {"width_deg": np.geomspace(0.02, 40.0, 30)}


FORMS = (
    Sticking(),
    AtRest(),
    Forwards(),
    Backwards(),
    EachWay(),
    DirectedEdges(),
    OutwardEdges(),
    Play(),
)
