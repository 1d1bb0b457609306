"""What the user ought to know beside a verdict: what was left aside, what no run has shown."""

import numpy as np

from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.naming.ranking import NO_CHANCE
from usmbench.diagnose.noise.noise_model import FARTHER

# Chosen while watching draws of simulated motors, seeds up to 17; no measurement fixes it.
_UNKNOWN, _MANY_ROWS = 0.1, 0.2  # of the highest speed; of the rows
_MANY_STEPS = 0.1  # of the steps: the few of a warm-up lead farther in any run


def left_aside(found: Found) -> list[str]:
    """Say what is beyond chance in one part of the runs only, where nothing is named.

    Parameters
    ----------
    found
        What the search came to.

    Returns
    -------
    list of str
        One warning, or none.
    """
    best = found.ranked[0]
    if best.p_value >= NO_CHANCE or best.effect.name in found.problem.known.habit_names:
        return []
    return [
        f"{best.effect.name} explains more than chance leaves, but not in parts of the runs that "
        "its fit has not seen, so it is no name; drive the plan again, or one that repeats its "
        "passes"
    ]


def unmeasured(found: Found) -> list[str]:
    """Say where the model was hardly measured.

    Parameters
    ----------
    found
        What the search came to.

    Returns
    -------
    list of str
        One warning, or none.
    """
    problem = found.problem
    uses = [s.use for s in problem.stretches]
    off_rad_s = np.concatenate(problem.unsure_rad_s(uses))[np.concatenate(uses)]
    share = float(np.mean(off_rad_s > _UNKNOWN * problem.known.features.top_rad_s))
    if share < _MANY_ROWS:
        return []
    return [
        f"on {100.0 * share:.0f} % of the rows the model may be off by {100.0 * _UNKNOWN:.0f} % of "
        "the highest speed and more, such as between phases that its runs did not drive: they tell "
        "little; identify it on a run that drives them"
    ]


def unseen_steps(found: Found) -> list[str]:
    """Say where a run's steps are larger than any whose course the model was identified on.

    A motor follows a large step later than a small one: its torque has a limit.

    Parameters
    ----------
    found
        What the search came to.

    Returns
    -------
    list of str
        One warning, or none.
    """
    problem = found.problem
    largest_rad_s = float(np.max(problem.noise.step_rad_s[0]))
    steps = np.concatenate([np.abs(s.step_rad_s[s.use & (s.lag == 0)]) for s in problem.stretches])
    n_larger = np.count_nonzero(steps > FARTHER * largest_rad_s)
    if n_larger <= _MANY_STEPS * steps.size:
        return []
    return [
        f"steps of up to {steps.max():.3g} rad/s, where the model's runs tell of steps of up to "
        f"{largest_rad_s:.2g} rad/s: how the motor follows larger ones it does not know; identify "
        "it on a run with such steps as well"
    ]
