"""Windows that stand alone and get no name: told, so that nobody takes them for judged."""

from collections.abc import Sequence

import numpy as np

from usmbench.diagnose.naming.apart_windows import beyond
from usmbench.diagnose.naming.sporadic import usual_windows
from usmbench.diagnose.naming.standing_alone import clear_rows
from usmbench.diagnose.noise.rotor_states import moved_rad_s, steady
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied

_TOLD = 2  # healthy runs have one now and then
_BEYOND = 2.0  # times the highest speed


def left_unnamed(problem: Problem, effects: Sequence[Applied], spread: float) -> list[str]:
    """Say of each stretch how many windows are not judged for standing alone.

    Parameters
    ----------
    problem
        The problem.
    effects
        The causes that are named.
    spread
        Standard deviation of the whitened noise, at least 1.

    Returns
    -------
    list of str
        A warning for each stretch that has such windows, for no move of its motor.
    """
    found = []
    left = problem.left_rad_s(effects)
    clear = clear_rows(problem, effects)
    not_judged = [
        (steady(s) | s.use & (np.abs(r) > moved_rad_s(s))) & ~mask & c
        for s, r, mask, c in zip(problem.stretches, left, problem.masks, clear, strict=True)
    ]
    far = beyond(problem, left, not_judged, spread)
    expected_hz = problem.known.expected_spikes_hz(with_left_out=True)
    for stretch, rows, residual in zip(problem.stretches, far, left, strict=True):
        off_rad_s = np.abs(residual[rows])
        duration_s = stretch.context.n * stretch.context.window_s
        top_rad_s = float(np.max(np.abs(stretch.simulated_rad_s), initial=0.0))
        usual = usual_windows(expected_hz, duration_s)
        many = off_rad_s.size >= max(_TOLD, usual)
        # No motor does that, not even once.
        if many or np.max(off_rad_s, initial=0.0) > _BEYOND * top_rad_s > 0.0:
            found.append(
                f"{stretch.name}: windows that stand alone are not judged: "
                f"{off_rad_s.size}, off by up to {np.max(off_rad_s):.3g} rad/s; no cause is named "
                "for them"
            )
    return found
