"""A motor that does what its simulation says, and not what its model's runs showed beside it.

A model is known to miss something, the same on each of its runs, and what a run leaves is held
against that. A run that leaves nothing, as one of the model itself does, departs from it, and yet
not from the simulation.
"""

from dataclasses import replace

import numpy as np

from usmbench.diagnose.fitting.fit import NOTHING
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.naming.verdict import verdict_on
from usmbench.diagnose.residual.views import omnibus
from usmbench.diagnose.residual.whole import whole_test


def as_simulated(found: Found) -> Found | None:
    """Return what is found of a run held against the simulation alone, where that is nothing.

    Parameters
    ----------
    found
        What a search came to.

    Returns
    -------
    Found or None
        Without names; None where the simulation leaves more than the noise, or what was named
        brings them nearer.
    """
    if not _within_noise(found):
        return None
    unnamed = found.drop_names()
    stretches = unnamed.problem.stretches
    problem = unnamed.problem.measuring([s.residual_rad_s for s in stretches])
    if found.named and problem.drop(found.fit.effects) > 0.0:
        return None
    whole = whole_test(problem, omnibus(problem), (), unnamed.spread)
    quiet = replace(unnamed, problem=problem, fit=NOTHING, before=whole, after=whole)
    return quiet if verdict_on(quiet, 0.0) == "no_discrepancy" else None


def _within_noise(found: Found) -> bool:
    """Whether all that the simulation leaves is as loud as the noise, or less."""
    left = [
        (s.residual_rad_s / found.problem.noise.level_rad_s(s))[s.use]
        for s in found.problem.stretches
    ]
    return bool(np.mean(np.concatenate(left) ** 2) <= 1.0)
