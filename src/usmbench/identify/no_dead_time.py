"""No dead time where the data do not ask for one.

A phase that glides shows lag and dead time together only. Of all that fit alike, the lag alone is
meant: with any other, the steps of another run would contradict the model.
"""

import math
from dataclasses import replace

import numpy as np

from usmbench.identify.lag_family import LagFamily
from usmbench.identify.output_error import fit_output_error
from usmbench.identify.projected import Projected
from usmbench.identify.robust_fit import RobustFit
from usmbench.identify.starting_dynamics import FINELY, PLAINLY


def without_needless_dead_time(search: RobustFit) -> RobustFit:
    """Return the fit with a lag alone, or as it is where that fits plainly worse.

    Parameters
    ----------
    search
        The fit. Where its family is a lag, that of the fit returned knows no dead time, either.
    """
    family = search.problem.family
    if not isinstance(family, LagFamily):
        return search
    lag, dead = (float(x) for x in search.problem.fit.parameters)
    if dead <= 0.0:
        return search
    alone = replace(family, longest_dead_time=0.0)
    as_late = np.array([math.log(math.exp(lag) + dead), 0.0])
    start = alone.moved(as_late, np.zeros(2))
    problem = search.problem
    problem = Projected(problem.stretches, alone, start, problem.weights, problem.penalties)
    fitted = fit_output_error(problem, FINELY)
    asked_for = fitted.fit.sse - search.problem.fit.sse
    if asked_for > PLAINLY * search.quietest_rad_s**2:
        return search
    return replace(search, problem=fitted)
