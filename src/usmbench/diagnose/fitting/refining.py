"""Refine all values of a fit together, by damped Gauss–Newton."""

from itertools import product

import numpy as np

from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.joint import Joint
from usmbench.diagnose.residual.problem import Problem

_STEPS = 10
_TOLERANCE = 1e-3
_NOTHING = 1e-6  # deviance: where a step that promises less fails, shorter ones promise nothing
_LEAPS, _STRIDES = 4, (0.5, 0.7, 0.85, 0.95, 1.05, 1.2, 1.4, 2.0)


def refine(problem: Problem, fit: Fit) -> Fit:
    """Improve all values of a fit together.

    Parameters
    ----------
    problem
        The problem.
    fit
        Where to start.
    """
    joint = Joint(problem, fit.effects)
    theta = joint.start
    dev, damping, slopes = joint.deviance(theta), 1e-3, None
    for _ in range(_STEPS if theta.size else 0):
        slopes = joint.slopes(theta) if slopes is None else slopes
        normal, slope = slopes
        scale = np.diag(np.maximum(np.diag(normal), 1e-12))
        step = np.linalg.solve(normal + damping * scale, slope)
        moved = joint.clipped(theta - step)
        new = joint.deviance(moved)
        if new >= dev:
            damping *= 10.0
            # Before it is clipped: of two that are held at their ends, a shorter one may free one.
            if damping > 1e4 or step @ (2.0 * slope - normal @ step) < _NOTHING:
                break
            continue
        gained, dev, theta, slopes = dev - new, new, moved, None
        damping = max(damping / 10.0, 1e-9)
        if gained < _TOLERANCE:
            break
    return Fit(joint.applied(theta), problem.deviance - dev, fit.roughness)


def refine_widely(problem: Problem, fit: Fit) -> Fit:
    """Improve all values of a fit, and look beyond where they come to rest.

    A sample that crosses the edge of the dead zone bends the deviance, and a descent may end there.

    Parameters
    ----------
    problem
        The problem.
    fit
        Where to start.
    """
    best = refine(problem, fit)
    joint = Joint(problem, fit.effects)
    null = np.array([p.null for p in joint.parameters])
    for _ in range(_LEAPS):
        theta = joint.vector(best.effects)
        starts = []
        for k, stride in product(range(theta.size), _STRIDES):
            moved = theta.copy()
            moved[k] = null[k] + stride * (theta[k] - null[k])
            moved = joint.clipped(moved)
            starts.append((joint.deviance(moved), joint.applied(moved)))
        if not starts:
            break
        dev, effects = min(starts, key=lambda start: start[0])
        if problem.deviance - dev <= best.statistic + _TOLERANCE:
            break
        best = refine(problem, Fit(effects, problem.deviance - dev, fit.roughness))
    return best
