"""Bound the values of a fit: 95 % intervals from how the deviance rises around them."""

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.fitting.aliases import alias_range
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.joint import Joint
from usmbench.diagnose.residual.problem import Problem

Array = NDArray[np.float64]

EDGE_95 = 3.84  # 95 % of chi-squared with one degree of freedom
_WIDER, _HALVINGS, _FOLLOWING = 16, 6, 2
_LESS = 0.9  # of what shapes an effect
AT_END = 0.99  # of the way from nothing to the end of what a size or a shape may be


def intervals(problem: Problem, fit: Fit, spread: float) -> list[dict[str, tuple[float, float]]]:
    """Return the 95 % interval of every parameter, by effect.

    Where nothing of an effect is scanned the deviance is taken for a parabola. What is scanned
    bends it, and the sizes that go with it lie along a bent valley, which is walked. A grid may fit
    as well on peaks of its own, which are looked for.

    Parameters
    ----------
    problem
        The problem.
    fit
        A refined fit.
    spread
        Standard deviation of the whitened noise, at least 1.
    """
    joint, rise = Joint(problem, fit.effects), EDGE_95 * spread**2
    theta = joint.start
    if theta.size == 0:
        return [{} for _ in fit.effects]
    half = _reach(joint.jacobian(theta), rise)
    low, high = theta.copy(), theta.copy()
    found, at = [], 0
    for applied in fit.effects:
        names = [p.name for p in applied.effect.parameters]
        own = list(range(at, at + len(names)))
        bent = [k for k in own if joint.parameters[k].scanned or not half[k] > 0.0]
        sizes = [k for k in own if k not in bent]
        if not bent:
            low[own], high[own] = theta[own] - half[own], theta[own] + half[own]
        for k in bent:
            nearest, farthest = _Profile(joint, theta, k, rise).passed(half[k])
            rows = [k, *sizes]
            low[rows] = np.minimum(low[rows], nearest[rows])
            high[rows] = np.maximum(high[rows], farthest[rows])
        if applied.effect.jagged and len(own) == 1:
            others = tuple(a for a in fit.effects if a is not applied)
            least, largest = alias_range(problem, applied, others, rise)
            low[own], high[own] = np.minimum(low[own], least), np.maximum(high[own], largest)
        low, high = joint.clipped(low), joint.clipped(high)
        ends = zip(low[own], high[own], strict=True)
        found.append({n: (float(a), float(b)) for n, (a, b) in zip(names, ends, strict=True)})
        at += len(names)
    return found


def leans_on_an_end(problem: Problem, fit: Fit, rise: float) -> bool:
    """Return whether what shapes an effect is as far out as is tried, and less fits plainly worse.

    Or as short as windows show: what is shorter does not swing, and is nothing.

    Parameters
    ----------
    problem
        The problem.
    fit
        A refined fit.
    rise
        Deviance that a tenth less brings at least.
    """
    joint = Joint(problem, fit.effects)
    window_s = problem.stretches[0].context.window_s
    for k, p in enumerate(joint.parameters):
        way = float(joint.start[k]) - p.null
        whole_way = (p.high if way > 0.0 else p.low) - p.null
        shortest = p.least_windows > 0.0 and _LESS * way < p.least_windows * window_s
        if p.scanned and (shortest or abs(way) > AT_END * abs(whole_way) > 0.0):
            risen, _ = _Profile(joint, joint.start, k, rise).rise(joint.start, p.null + _LESS * way)
            if risen > rise:
                return True
    return False


def _reach(jacobian: Array, rise: float) -> Array:
    """Return how far each parameter may go until the deviance has risen by so much."""
    covariance = np.linalg.pinv(jacobian.T @ jacobian)
    return np.asarray(np.sqrt(rise * np.maximum(np.diag(covariance), 0.0)))


class _Profile:
    """The deviance over one parameter, the others at their best for each of its values."""

    def __init__(self, joint: Joint, theta: Array, k: int, rise: float):
        self._joint, self._theta, self._k, self._edge_rise = joint, theta, k, rise
        here = joint.left(theta)
        self._least = float(here @ here)
        self._passed = [(0.0, theta)]

    def passed(self, half: float) -> tuple[Array, Array]:
        """Return between which values every parameter lies within the deviance's rise.

        Parameters
        ----------
        half
            How far the one may go by a parabola; 0 where that does not say.
        """
        k, p = self._k, self._joint.parameters[self._k]
        step = min(half, p.typical) if half > 0.0 else 0.1 * p.typical
        ends = [self._edge(side * step) for side in (-1.0, 1.0)]
        low, high = self._theta.copy(), self._theta.copy()
        for risen, theta in self._passed:
            others = np.delete(self._joint.jacobian(theta), k, axis=1)
            reach = np.insert(_reach(others, self._edge_rise - risen), k, 0.0)
            low, high = np.minimum(low, theta - reach), np.maximum(high, theta + reach)
        low[k], high[k] = ends
        return low, high

    def _edge(self, step: float) -> float:
        """Return where the deviance has risen so far on the side that a first step leads to."""
        p, start = self._joint.parameters[self._k], float(self._theta[self._k])
        inside = outside = start
        theta = self._theta
        for _ in range(_WIDER):
            outside = float(np.clip(start + step, p.low, p.high))
            risen, best = self.rise(theta, outside)
            if risen > self._edge_rise or outside in (p.low, p.high):
                break
            inside, theta, step = outside, best, 2.0 * step
        for _ in range(_HALVINGS):
            middle = 0.5 * (inside + outside)
            risen, best = self.rise(theta, middle)
            if risen > self._edge_rise:
                outside = middle
            else:
                inside, theta = middle, best
        return outside

    def rise(self, theta: Array, value: float) -> tuple[float, Array]:
        """Move one parameter, and the others after it; return the deviance's rise, and where.

        Parameters
        ----------
        theta
            Where to begin, shape (P,).
        value
            Where the one is moved to.
        """
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
        risen = dev - self._least
        if risen <= self._edge_rise:
            self._passed.append((max(risen, 0.0), moved))
        return risen, moved
