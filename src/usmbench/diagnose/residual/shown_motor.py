"""A motor that shows effects: its runs, and what the model is known to leave of them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch, stepped
from usmbench.diagnose.known.knowledge import Knowledge
from usmbench.model.applied import Applied
from usmbench.model.extended import linear_part, moving_starts, through

Array = NDArray[np.float64]


def shown_by(stretch: Stretch, change_rad_s: Array, effects: Sequence[Applied]) -> Stretch:
    """Return a stretch as a motor with effects drives it: its phases, its lag, its speed.

    Parameters
    ----------
    stretch
        The stretch.
    change_rad_s
        What the effects change of the speed, shape (N,).
    effects
        The effects. A grid of phases leaves them: what is known of the phases near each other is
        an average over them.
    """
    context = replace(stretch.context, linear=linear_part(effects, stretch.context))
    simulated_rad_s = stretch.simulated_rad_s + change_rad_s
    shown = replace(stretch, simulated_rad_s=simulated_rad_s, context=context)
    commands = moving_starts(effects)
    if not commands:
        return shown
    phase_deg = through(commands, "command", context.phase_deg, context)
    settled_rad_s = context.settled_rad_s(phase_deg)
    begins = np.arange(context.n) - stretch.lag
    return replace(
        shown,
        settled_rad_s=settled_rad_s,
        step_rad_s=stepped(settled_rad_s, begins),
        direction=np.sign(stepped(phase_deg, begins)),
        context=replace(context, phase_deg=phase_deg),
    )


def counters_of(effects: Sequence[Applied]) -> list[Applied]:
    """Return what a counter does to every count alike.

    What one takes by chance beyond a knee is left out: small errors decide there who is beyond.

    Parameters
    ----------
    effects
        All effects.
    """
    return [a for a in effects if a.effect.stage == "counter" and not a.effect.by_chance]


def expected_as_counted(
    known: Knowledge, stretch: Stretch, change_rad_s: Array, counters: Sequence[Applied]
) -> Array:
    """Return the mean residual that is no news behind a counter that does not count right.

    What takes part of the speed, or turns its sign, does so to the model's error as well.

    Parameters
    ----------
    known
        What is known of the model.
    stretch
        The stretch.
    change_rad_s
        What other causes change before the counter, shape (N,).
    counters
        What the counter does, as from `counters_of`.

    Returns
    -------
    Array
        In rad/s, shape (N,).
    """
    shaft_rad_s = stretch.simulated_rad_s + change_rad_s
    off_rad_s = known.expected_rad_s(replace(stretch, simulated_rad_s=shaft_rad_s))
    reported, simulated = (
        through(counters, "counter", speed_rad_s, stretch.context)
        for speed_rad_s in (shaft_rad_s + off_rad_s, shaft_rad_s)
    )
    return reported - simulated
