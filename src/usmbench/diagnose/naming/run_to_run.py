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
    if not fit.effects or not 1 < len(names) <= _MOST_RUNS:
        return []
    more, fits = 0.0, []
    for run in names:
        pairs = zip(problem.stretches, problem.masks, strict=True)
        alone = problem.with_masks([mask & (s.run == run) for s, mask in pairs])
        fits.append(refine(alone, fit))
        more += max(fits[-1].statistic - alone.drop(fit.effects), 0.0) / spread**2
    parameters = [(k, p) for k, a in enumerate(fit.effects) for p in a.effect.parameters]
    if not parameters or chdtrc((len(fits) - 1) * len(parameters), more) > _LEVEL:
        return []
    values = np.array([[f.effects[k].values[p.name] for k, p in parameters] for f in fits])
    together = np.array([fit.effects[k].values[p.name] - p.null for k, p in parameters])
    apart = np.ptp(values, axis=0) / np.maximum(np.abs(together), 1e-12)
    most = int(np.argmax(apart))
    k, parameter = parameters[most]
    told = ", ".join(
        f"{v:.3g} in {n}" for v, n in zip(values[:, most], names.values(), strict=True)
    )
    return [
        f"{fit.effects[k].effect.name} differs from run to run ({parameter.name} {told}): the "
        "value given lies between them; --each judges every run on its own"
    ]
