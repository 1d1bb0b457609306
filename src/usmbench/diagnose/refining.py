"""Refine all values of a fit together, by damped Gauss–Newton, and bound them."""

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.fitting import Fit
from usmbench.diagnose.problem import Problem
from usmbench.model.effects.base import Effect
from usmbench.model.extended import Applied

Array = NDArray[np.float64]

_STEPS = 10
_TOLERANCE = 1e-3
_LEAPS, _STRIDES = 4, (0.5, 0.7, 0.85, 0.95, 1.05, 1.2, 1.4, 2.0)
_STEP_SHARE = 0.05  # of the typical size, for derivatives
_EDGE_95 = 3.84  # 95 % of chi-squared with one degree of freedom


def refine(problem: Problem, fit: Fit) -> Fit:
    """Improve all values of a fit together.

    Parameters
    ----------
    problem
        The problem.
    fit
        Where to start.
    """
    joint = _Joint(problem, [a.effect for a in fit.effects])
    theta = joint.vector(fit.effects)
    here = joint.left(theta)
    dev, damping = float(here @ here), 1e-3
    for _ in range(_STEPS if theta.size else 0):
        jacobian = joint.jacobian(theta)
        normal, slope = jacobian.T @ jacobian, jacobian.T @ here
        scale = np.diag(np.maximum(np.diag(normal), 1e-12))
        moved = joint.clipped(theta - np.linalg.solve(normal + damping * scale, slope))
        there = joint.left(moved)
        new = float(there @ there)
        if new >= dev:
            damping *= 10.0
            if damping > 1e4:
                break
            continue
        gained, dev, theta, here = dev - new, new, moved, there
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
    joint = _Joint(problem, [a.effect for a in fit.effects])
    null = np.array([p.null for p in joint.parameters])
    for _ in range(_LEAPS):
        theta = joint.vector(best.effects)
        starts = []
        for k, stride in product(range(theta.size), _STRIDES):
            moved = theta.copy()
            moved[k] = null[k] + stride * (theta[k] - null[k])
            left = joint.left(joint.clipped(moved))
            starts.append((float(left @ left), joint.applied(joint.clipped(moved))))
        if not starts:
            break
        dev, effects = min(starts, key=lambda start: start[0])
        if problem.deviance - dev <= best.statistic + _TOLERANCE:
            break
        best = refine(problem, Fit(effects, problem.deviance - dev, fit.roughness))
    return best


def intervals(problem: Problem, fit: Fit) -> list[dict[str, tuple[float, float]]]:
    """Return the 95 % interval of every parameter, by effect.

    Parameters
    ----------
    problem
        The problem.
    fit
        A refined fit.
    """
    joint = _Joint(problem, [a.effect for a in fit.effects])
    theta = joint.vector(fit.effects)
    if theta.size == 0:
        return [{} for _ in fit.effects]
    here = joint.left(theta)
    jacobian = joint.jacobian(theta)
    covariance = np.linalg.pinv(jacobian.T @ jacobian)
    half = np.sqrt(_EDGE_95 * np.maximum(np.diag(covariance), 0.0))
    low, high = joint.clipped(theta - half), joint.clipped(theta + half)
    for k in range(theta.size):
        if joint.parameters[k].scanned or not half[k] > 0.0:
            low[k], high[k] = (joint.edge(theta, k, side, float(here @ here)) for side in (-1, 1))
    found, at = [], 0
    for applied in fit.effects:
        own = applied.effect.parameters
        found.append({p.name: (float(low[at + i]), float(high[at + i])) for i, p in enumerate(own)})
        at += len(own)
    return found


class _Joint:
    """All parameters of several effects as one vector."""

    def __init__(self, problem: Problem, effects: Sequence[Effect]):
        self._problem, self._effects = problem, effects
        self.parameters = [p for e in effects for p in e.parameters]

    def vector(self, applied: Sequence[Applied]) -> Array:
        return np.array([a.values[p.name] for a in applied for p in a.effect.parameters])

    def applied(self, theta: Array) -> tuple[Applied, ...]:
        found, at = [], 0
        for effect in self._effects:
            own = {p.name: float(theta[at + i]) for i, p in enumerate(effect.parameters)}
            found.append(Applied(effect, own))
            at += len(own)
        return tuple(found)

    def clipped(self, theta: Array) -> Array:
        low = np.array([p.low for p in self.parameters])
        high = np.array([p.high for p in self.parameters])
        return np.asarray(np.clip(theta, low, high), dtype=np.float64)

    def left(self, theta: Array) -> Array:
        return self._problem.left(self.applied(theta))

    def jacobian(self, theta: Array) -> Array:
        """Return how the carried residual changes with each parameter, shape (M, parameters)."""
        base = self._problem.change_rad_s(self.applied(theta))
        slopes = []
        for k, p in enumerate(self.parameters):
            step = _STEP_SHARE * p.typical
            if theta[k] + step > p.high:
                step = -step
            moved = theta.copy()
            moved[k] += step
            there = self._problem.change_rad_s(self.applied(moved))
            slopes.append([(b - t) / step for t, b in zip(there, base, strict=True)])
        return self._problem.carried([np.column_stack(part) for part in zip(*slopes, strict=True)])

    def edge(self, theta: Array, k: int, side: int, dev: float) -> float:
        """Where the deviance has risen by 3.84 on one side, the others held."""
        p = self.parameters[k]
        bound = p.low if side < 0 else p.high

        def rise(value: float) -> float:
            moved = theta.copy()
            moved[k] = value
            left = self.left(moved)
            return float(left @ left) - dev

        step = 0.02 * p.typical
        inside = outside = float(theta[k])
        for _ in range(24):
            outside = float(np.clip(theta[k] + side * step, p.low, p.high))
            if outside == bound or rise(outside) > _EDGE_95:
                break
            inside, step = outside, 1.7 * step
        for _ in range(6):
            middle = 0.5 * (inside + outside)
            inside, outside = (inside, middle) if rise(middle) > _EDGE_95 else (middle, outside)
        return outside
