"""Whether what is named has another size in each of several runs."""

import numpy as np
from scipy.special import chdtrc

from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.refining import refine
from usmbench.diagnose.residual.problem import Problem

_LEVEL = 1e-3  # beyond chance, and beyond what the noise's own estimate is off by
_MOST_RUNS = 12  # each takes a fit of its own


def sizes_by_run(problem: Problem, fit: Fit, spread: float) -> list[str]:
    """Say where the values of what is named differ from run to run by more than chance.

    What each run gains by values of its own is chi-squared (Cochran 1954, doi:10.2307/3001666).

    Parameters
    ----------
    problem
        The problem.
    fit
        All that is named, as it fits the runs together.
    spread
        Standard deviation of the whitened noise, at least 1.

    Returns
    -------
    list of str
        One warning, with the value that differs most, or none.
    """
    names = {s.run: s.name for s in problem.stretches}
    parameters = [(k, p) for k, a in enumerate(fit.effects) for p in a.effect.parameters]
    if not parameters or not 1 < len(names) <= _MOST_RUNS:
        return []
    fits, gains = zip(*(_alone(problem, fit, run) for run in names), strict=True)
    free = (len(fits) - 1) * len(parameters)
    if chdtrc(free, sum(gains) / spread**2) > _LEVEL:
        return []
    values = np.array([[f.effects[k].values[p.name] for k, p in parameters] for f in fits])
    together = np.array([fit.effects[k].values[p.name] - p.null for k, p in parameters])
    most = int(np.argmax(np.ptp(values, axis=0) / np.maximum(np.abs(together), 1e-12)))
    k, parameter = parameters[most]
    each = zip(values[:, most], names.values(), strict=True)
    told = ", ".join(f"{value:.3g} in {name}" for value, name in each)
    return [
        f"{fit.effects[k].effect.name} differs from run to run ({parameter.name} {told}): the "
        "value given lies between them; --each judges every run on its own"
    ]


def _alone(problem: Problem, fit: Fit, run: int) -> tuple[Fit, float]:
    """Fit one run, and say by how much its own values lower the deviance below common ones."""
    pairs = zip(problem.stretches, problem.masks, strict=True)
    alone = problem.with_masks([mask & (s.run == run) for s, mask in pairs])
    own = refine(alone, fit)
    return own, max(own.statistic - alone.drop(fit.effects), 0.0)
