"""No dead time where the data do not ask for one.

A phase that glides shows lag and dead time together only. Of all that fit alike, the lag alone is
meant: with any other, the steps of another run would contradict the model.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from usmbench.identify.dynamics import Family
from usmbench.identify.lag_family import LagFamily
from usmbench.identify.output_error import fit_output_error
from usmbench.identify.projected import Projected
from usmbench.identify.robust_fit import RobustFit
from usmbench.identify.starting_dynamics import FINELY, PLAIN_DEVIANCE

_SHARE = 0.1  # of the sum of squares: a curve that misses corners bends time, too
_NEAR = 20.0  # times what decides: beyond, no search from there comes near it
_HALF = 0.5  # windows by which an average comes later than what is read at the window's end


def without_needless_dead_time(search: RobustFit) -> tuple[RobustFit, Family]:
    """Return the fit with a lag alone, or as it is where that fits plainly worse.

    Parameters
    ----------
    search
        The fit.

    Returns
    -------
    RobustFit, Family
        The fit, and the family to go on in, which has no dead time where none is asked for.
    """
    problem, family = search.problem, search.problem.family
    asked_for = max(PLAIN_DEVIANCE * search.quietest_rad_s**2, _SHARE * problem.fit.sse)
    most = problem.fit.sse + asked_for
    if not isinstance(family, LagFamily) or problem.fit.parameters[1] == 0.0:
        return search, family
    alone = list(_alone(problem, family, most))
    best, pinned = min(alone, key=lambda pair: pair[0].fit.sse, default=(problem, family))
    if best is problem or best.fit.sse > most:
        return search, family
    # What is not asked for is not known either: intervals need the derivative by it.
    free = replace(family, sampled=pinned.sampled)
    known = Projected(
        problem.stretches, free, best.fit.parameters, problem.weights, problem.penalties
    )
    return replace(search, problem=known), pinned


def _alone(
    problem: Projected, family: LagFamily, most: float
) -> Iterator[tuple[Projected, LagFamily]]:
    """Fit lags alone, to averages and, where speeds were taken for them, to samples."""
    lag, dead = (float(x) for x in problem.fit.parameters)
    for sampled in {family.sampled, False}:
        pinned = replace(family, sampled=sampled, longest_dead_time=0.0)
        late = math.exp(lag) + dead - _HALF * (family.sampled - sampled)
        start = pinned.moved(np.array([math.log(max(late, 1e-9)), 0.0]), np.zeros(2))
        there = Projected(problem.stretches, pinned, start, problem.weights, problem.penalties)
        if there.fit.sse < problem.fit.sse + _NEAR * (most - problem.fit.sse):
            yield fit_output_error(there, FINELY), pinned
