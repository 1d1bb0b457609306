"""How a run's speed departs with each thing that wanders."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.dead_zone import edge_of_standstill_deg, highest_rad_s
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.shapes import (
    detuned_rad_s,
    held_back,
    later_rad_s_per_s,
    shown,
    speed_share,
    widening_by_share,
)
from usmbench.diagnose.known.wander import COLUMNS, WARMS
from usmbench.diagnose.known.wander_shares import ANY
from usmbench.model.applied import Applied
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import CREST_DEG
from usmbench.model.linear import free_run

Array = NDArray[np.float64]

_STICKING = (0.0, 0.02, 0.05)  # shares of the highest speed: from, most, to
_STEP = 0.1  # of a habit's size, for its derivative


def departures(stretch: Stretch, habits: Sequence[Applied], n_constants: int) -> Array:
    """Return the change of speed with each thing that wanders, in columns of shape (N, W).

    The crests may be faster or slower, by a share of the speed. A jump may come later. Friction may
    hold the rotor back more or less: most near standstill, where the wave is a standing one, not at
    all at the highest speed, and at each operating point by another amount, since it is the
    vibration that frees the rotor. A gain that wanders shows the latter, too: the rotor follows the
    crests but for the slip, so that the gain is off by another share at the highest speed and at
    another frequency or torque. A rotor that sticks may come free at a larger phase, and the dead
    zone be wider, whatever makes it so, on one side more than on the other, and toward the ends of
    the curve by another amount. As the motor warms, gain, friction, dead zone and resonance may
    change otherwise. And what healthy runs show anyhow may be stronger.

    Parameters
    ----------
    stretch
        The stretch.
    habits
        What healthy runs show anyhow.
    n_constants
        Number of thermal time constants, from the shortest on.
    """
    share = speed_share(stretch)
    stuck = -np.sign(share) * np.interp(np.abs(share), _STICKING, (0.0, 1.0, 0.0))
    gain, held, wider, detuned = changes = _changes(stretch)
    fast = 2.0 * np.minimum(np.abs(share), 1.0) - 1.0
    side, beyond_deg = np.sign(stretch.context.phase_deg), edge_of_standstill_deg(stretch)
    toward_end = (np.abs(stretch.context.phase_deg) - beyond_deg) / (CREST_DEG - beyond_deg)
    places = np.column_stack((fast, *stretch.places))
    found = {
        "gain": gain,
        "gain_tilt": shown(stretch, stretch.settled_rad_s[:, None] * places),
        "late_s": later_rad_s_per_s(stretch),
        "resonance": detuned,
        "stuck_rad_s": shown(stretch, stuck),
        "wider": wider,
        "one_sided": widening_by_share(stretch, np.sign(stretch.context.phase_deg)),
        "one_sided_ends": widening_by_share(stretch, side * np.clip(toward_end, 0.0, 1.0)),
        "held_back_rad_s": held,
        "habit_share": _stronger(stretch, habits),
    }
    warms = _warming(stretch, changes, slice(0, n_constants))
    found |= zip(WARMS, warms, strict=True)
    return np.column_stack([found[name] for name in COLUMNS])


def unwatched_warming(stretch: Stretch, n_known: int, n_lasts: int) -> Array:
    """Return what a motor may do as it warms for longer than was watched, shape (N, K).

    Parameters
    ----------
    stretch
        The stretch.
    n_known
        Number of thermal time constants that runs have shown.
    n_lasts
        The same of those that run now.

    Returns
    -------
    Array
        One column a standard deviation, in rad/s.
    """
    if n_lasts <= n_known:
        return np.empty((stretch.context.n, 0))
    gain, held, wider, detuned = _changes(stretch)
    sized = (
        ANY.warms_gain * gain,
        ANY.warms_held * float(np.max(highest_rad_s(stretch))) * held,
        ANY.warms_wider * wider,
        ANY.warms_shift * detuned,
    )
    # The longest of those shown stood in for all that are longer.
    return np.column_stack(list(_warming(stretch, sized, slice(n_known - 1, n_lasts))))


def _changes(stretch: Stretch) -> tuple[Array, Array, Array, Array]:
    """Change with the gain, with friction at each point, with the dead zone and the resonance."""
    linear, settled_rad_s = stretch.context.linear, stretch.settled_rad_s
    gain = stretch.simulated_rad_s
    if linear.slip_limit_rad_s is not None:  # which does not grow with it
        limited_rad_s = free_run(linear, settled_rad_s, float(settled_rad_s[0]))
        gain = gain - (limited_rad_s - shown(stretch, settled_rad_s))
    held = shown(stretch, np.column_stack(stretch.points) * held_back(stretch)[:, None])
    return gain, held, widening_by_share(stretch), detuned_rad_s(stretch)


def _warming(
    stretch: Stretch, changes: tuple[Array, Array, Array, Array], constants: slice
) -> Iterator[Array]:
    """Yield changes, times how long the motor is driven, through thermal lags, (N, constants)."""
    gain, held, wider, detuned = changes
    # Where it is known, the resonance's move takes friction along.
    friction = held.sum(axis=1) * (stretch.context.detuning_rad_s is None)
    for change in (gain, friction, wider, detuned):
        # Laid out as the other columns: the last digit of a product goes by it.
        yield np.ascontiguousarray((change * stretch.warmth[0, constants]).T)


def _stronger(stretch: Stretch, habits: Sequence[Applied]) -> Array:
    """Return the change of speed for each share by which habits are stronger, shape (N,)."""
    if not habits:
        return np.zeros(stretch.context.n)
    more = [replace(h, values={**h.values, **_further(h)}) for h in habits]
    usual, stronger = (extended_run(e, stretch.context).speed_rad_s for e in (habits, more))
    return (stronger - usual) / _STEP


def _further(habit: Applied) -> dict[str, float]:
    """Sizes of a habit that is a little stronger."""
    sized = (p for p in habit.effect.parameters if not p.scanned)
    return {p.name: p.null + (1.0 + _STEP) * (habit.values[p.name] - p.null) for p in sized}
