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
_WIDER, _HALVINGS, _FOLLOWING = 16, 6, 2


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
    jacobian = joint.jacobian(theta)
    covariance = np.linalg.pinv(jacobian.T @ jacobian)
    half = np.sqrt(_EDGE_95 * np.maximum(np.diag(covariance), 0.0))
    low, high = joint.clipped(theta - half), joint.clipped(theta + half)
    for k, p in enumerate(joint.parameters):
        if p.scanned or not half[k] > 0.0:
            step = min(half[k], p.typical) if half[k] > 0.0 else 0.1 * p.typical
            profile = _Profile(joint, theta, k)
            low[k], high[k] = (profile.edge(side * step) for side in (-1.0, 1.0))
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


class _Profile:
    """The deviance over one parameter, the others at their best for each of its values."""

    def __init__(self, joint: _Joint, theta: Array, k: int):
        self._joint, self._theta, self._k = joint, theta, k
        here = joint.left(theta)
        self._least = float(here @ here)

    def edge(self, step: float) -> float:
        """Return where the deviance has risen by 3.84 on the side that a first step leads to."""
        p, start = self._joint.parameters[self._k], float(self._theta[self._k])
        inside = outside = start
        theta = self._theta
        for _ in range(_WIDER):
            outside = float(np.clip(start + step, p.low, p.high))
            risen, best = self._rise(theta, outside)
            if risen > _EDGE_95 or outside in (p.low, p.high):
                break
            inside, theta, step = outside, best, 2.0 * step
        for _ in range(_HALVINGS):
            middle = 0.5 * (inside + outside)
            risen, best = self._rise(theta, middle)
            if risen > _EDGE_95:
                outside = middle
            else:
                inside, theta = middle, best
        return outside

    def _rise(self, theta: Array, value: float) -> tuple[float, Array]:
        """Move one parameter, and the others after it; return the deviance's rise, and where."""
        joint, moved = self._joint, theta.copy()
        moved[self._k] = value
        here = joint.left(moved)
        dev = float(here @ here)
        for _ in range(_FOLLOWING if theta.size > 1 else 0):
            jacobian = np.delete(joint.jacobian(moved), self._k, axis=1)
            step = np.insert(-np.linalg.lstsq(jacobian, here, rcond=None)[0], self._k, 0.0)
            there = joint.clipped(moved + step)
            left = joint.left(there)
            if float(left @ left) >= dev:
                break
            moved, here, dev = there, left, float(left @ left)
        return dev - self._least, moved
