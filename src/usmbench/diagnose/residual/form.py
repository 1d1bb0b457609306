"""How far the form of an effect may be off: it is no motor, and what it leaves is no news.

A large effect that is right in its kind leaves a share of itself, by speed, direction, and time
since each kind of step, that a further cause would be made of.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.noise.chance_scatter import chance_scatter_rad_s
from usmbench.diagnose.noise.rotor_states import KINDS, step_kind
from usmbench.model.applied import Applied
from usmbench.model.effects.base import PHYSICS
from usmbench.model.extended import extended_run
from usmbench.model.polygon import hats

Array = NDArray[np.float64]

ROUGHLY = 0.02  # the same from window to window
_SPEEDS = (0.0, 0.1, 0.3, 0.6, 1.0)  # of the highest
_LAGS = (0.0, 1.0, 2.0, 4.0, 10.0)  # windows since the step


def off_in_form(stretch: Stretch, change_rad_s: Array, form_off: float = PHYSICS) -> Array:
    """Return by what an effect may be off, in columns of one standard deviation, shape (N, D).

    It may also come sooner or later: a model of slow runs knows little of the motor's lag.

    Parameters
    ----------
    stretch
        The stretch.
    change_rad_s
        What the effect changes, shape (N,).
    form_off
        Standard deviation, as a share of the effect.
    """
    settled = np.abs(stretch.settled_rad_s)
    share = settled / max(float(np.max(settled, initial=0.0)), 1e-12)
    kind, after_step = step_kind(stretch), list(hats(stretch.lag.astype(float), np.array(_LAGS)))
    columns = [
        *hats(share, np.array(_SPEEDS)),
        *(after * (kind == k) for k in range(KINDS) for after in after_step),
        np.sign(stretch.settled_rad_s),
    ]
    later = np.diff(change_rad_s, prepend=change_rad_s[:1])
    every = (change_rad_s[:, None] * np.column_stack(columns), later)
    return np.asarray(form_off * np.column_stack(every))


def edges_elsewhere(
    stretch: Stretch, own: Sequence[Applied], effects: Sequence[Applied], share: float
) -> Array:
    """Return what effects change otherwise where the dead zone ends elsewhere, shape (N, 4).

    A weight pulls at once where the rotor begins to turn, and that is elsewhere on another day.

    Parameters
    ----------
    stretch
        The stretch.
    own
        The model's own effects.
    effects
        Those beyond them.
    share
        By which share of its phase either edge lies farther in or out.
    """
    context = stretch.context
    side, every = np.sign(context.phase_deg), (*own, *effects)
    contexts = [context]
    for moved in (-share, share):
        contexts += [
            replace(context, phase_deg=context.phase_deg * (1.0 + moved * (side == one)))
            for one in (-1.0, 1.0)
        ]
    here, *there = [
        extended_run(every, c).speed_rad_s - extended_run(own, c).speed_rad_s for c in contexts
    ]
    return np.column_stack([changed - here for changed in there])


def doubting_own(
    stretches: Sequence[Stretch], own: Sequence[Applied], doubted: Sequence[Applied]
) -> list[Stretch]:
    """Say how far the effects of an extended model may be off.

    Parameters
    ----------
    stretches
        The runs.
    own
        All effects with which they were simulated.
    doubted
        Those among them that a diagnosis has named.
    """
    if not doubted:
        return list(stretches)
    changes = [[_change_rad_s(s, own, each) for each in doubted] for s in stretches]
    by_chance = np.array([each.effect.by_chance for each in doubted])
    scatter = chance_scatter_rad_s(
        [by_chance @ np.array(every) for every in changes],
        [s.residual_rad_s for s in stretches],
        [s.use for s in stretches],
    )
    return [
        replace(s, doubt_rad_s=_off(s, every, doubted), scatter_rad_s=scattered)
        for s, every, scattered in zip(stretches, changes, scatter, strict=True)
    ]


def _change_rad_s(stretch: Stretch, own: Sequence[Applied], each: Applied) -> Array:
    """Return what one of a model's own effects changes, shape (N,)."""
    without = extended_run([a for a in own if a is not each], stretch.context).speed_rad_s
    return stretch.simulated_rad_s - without


def _off(stretch: Stretch, changes: Sequence[Array], doubted: Sequence[Applied]) -> Array:
    """Return by what a model's own effects may be off, shape (N, D)."""
    pairs = zip(changes, doubted, strict=True)
    return np.column_stack([off_in_form(stretch, c, a.effect.form_off) for c, a in pairs])
