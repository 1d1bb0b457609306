"""Fit effects to the whitened residual: a scan of what shapes them, then damped Gauss–Newton."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from usmbench.diagnose.problem import Problem
from usmbench.model.effects.base import Effect, Parameter
from usmbench.model.extended import Applied

Array = NDArray[np.float64]

_ZOOM_ROUNDS = 2
_ZOOM_POINTS = 7
_STEPS = 10
_TOLERANCE = 1e-3
_STEP_SHARE = 0.05  # of the typical size, for derivatives
_AT_ONCE = 64  # columns carried together
_EDGE_95 = 3.84  # 95 % of chi-squared with one degree of freedom


@dataclass(frozen=True, slots=True)
class Fit:
    """Effects at their best values.

    Parameters
    ----------
    effects
        The effects with their values.
    statistic
        Drop of the deviance against no effect.
    roughness
        Total variation of the normalised effect over the scan; see `p_value`.
    """

    effects: tuple[Applied, ...]
    statistic: float
    roughness: float

    @property
    def n_parameters(self) -> int:
        """Number of fitted parameters."""
        return sum(len(a.effect.parameters) for a in self.effects)

    @property
    def free(self) -> int:
        """Degrees of freedom of the statistic at one point of the scan."""
        sized = [p for a in self.effects for p in a.effect.parameters if not p.scanned]
        return max(len(sized), 1)

    @property
    def p_value(self) -> float:
        """Probability of such a statistic where nothing is wrong, for this effect alone.

        For a scanned parameter, Davies' bound on the supremum of a chi process (1987,
        doi:10.1093/biomet/74.1.33): the tail at one point, plus the variation times
        ``exp(−u/2)/π``.
        """
        u = max(self.statistic, 0.0)
        tail = float(chi2.sf(u, self.free)) + self.roughness * math.exp(-0.5 * u) / math.pi
        return min(tail, 1.0)


def fit_effect(problem: Problem, effect: Effect, given: Sequence[Applied] = ()) -> Fit:
    """Fit one effect, beside others that are held where they are.

    Parameters
    ----------
    problem
        The problem.
    effect
        The effect.
    given
        Effects that act already; the statistic counts from them.
    """
    search = _Search(problem, effect, tuple(given))
    scanned = [p for p in effect.parameters if p.scanned]
    sized = [p for p in effect.parameters if not p.scanned]
    if scanned:
        values, drop, roughness = search.scan(scanned, sized)
    else:
        ((values, drop, _),), roughness = search.best([{}], sized), 0.0
    return Fit((*given, Applied(effect, values)), drop, roughness)


def sharpen(problem: Problem, fit: Fit, given: Sequence[Applied] = ()) -> Fit:
    """Try ever finer values of what was scanned, around those of the grid.

    Parameters
    ----------
    problem
        The problem.
    fit
        What `fit_effect` found.
    given
        Effects that act already, as they were given to `fit_effect`.
    """
    last = fit.effects[-1]
    scanned = [p for p in last.effect.parameters if p.scanned]
    sized = [p for p in last.effect.parameters if not p.scanned]
    search = _Search(problem, last.effect, tuple(given))
    grids = last.effect.grid([s.context for s in problem.stretches]) if scanned else {}
    best = (dict(last.values), fit.statistic)
    for p in scanned:
        best = search.zoomed(best, p, np.clip(grids[p.name], p.low, p.high), scanned, sized)
    return Fit((*given, Applied(last.effect, best[0])), best[1], fit.roughness)


def refine(problem: Problem, fit: Fit, base: float | None = None) -> Fit:
    """Improve all values of a fit together.

    Parameters
    ----------
    problem
        The problem.
    fit
        Where to start.
    base
        Deviance from which the statistic counts; None for that without effects.
    """
    start = problem.deviance if base is None else base
    joint = _Joint(problem, [a.effect for a in fit.effects])
    theta = joint.vector(fit.effects)
    here = joint.left(theta)
    dev, damping = float(here @ here), 1e-3
    for _ in range(_STEPS if theta.size else 0):
        jacobian = joint.jacobian(theta, here)
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
    return Fit(joint.applied(theta), start - dev, fit.roughness)


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
    jacobian = joint.jacobian(theta, here)
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


class _Search:
    """One effect beside fixed ones."""

    def __init__(self, problem: Problem, effect: Effect, given: tuple[Applied, ...]):
        self._problem, self._effect, self._given = problem, effect, given
        self._base = problem.change_rad_s(given) if given else None
        self._left = problem.residual
        if self._base is not None:
            self._left = problem.residual - problem.carried(self._base)
        self._dev = float(self._left @ self._left)

    def columns(self, points: Sequence[Mapping[str, float]]) -> Array:
        """Return the carried changes that the effect makes at each point, shape (M, points)."""
        changes = [
            self._problem.change_rad_s((*self._given, Applied(self._effect, values)))
            for values in points
        ]
        parts = [np.column_stack(part) for part in zip(*changes, strict=True)]
        if self._base is not None:
            parts = [part - base[:, None] for part, base in zip(parts, self._base, strict=True)]
        return self._problem.carried(parts)

    def best(
        self, shapes: Sequence[Mapping[str, float]], sized: Sequence[Parameter]
    ) -> Iterator[tuple[dict[str, float], float, Array]]:
        """Yield the best values at each shape, the drop they bring, and the unit column."""
        for at in range(0, len(shapes), _AT_ONCE):
            chunk = shapes[at : at + _AT_ONCE]
            if not sized:
                columns = self.columns(chunk)
                drops = 2.0 * (self._left @ columns) - np.sum(columns**2, axis=0)
                for shape, drop, column in zip(chunk, drops, columns.T, strict=True):
                    yield dict(shape), float(drop), column
                continue
            nulls = {q.name: q.null for q in sized}
            points = [
                {**shape, **nulls, p.name: p.null + p.typical} for shape in chunk for p in sized
            ]
            typical = np.tile([p.typical for p in sized], len(chunk))
            columns = self.columns(points) / typical
            for k, shape in enumerate(chunk):
                own = columns[:, k * len(sized) : (k + 1) * len(sized)]
                yield *self._sized(shape, sized, own), own[:, 0]

    def _sized(
        self, shape: Mapping[str, float], sized: Sequence[Parameter], matrix: Array
    ) -> tuple[dict[str, float], float]:
        """Return the best sizes at fixed shape, to first order, and the drop they bring."""
        normal, slope = matrix.T @ matrix, matrix.T @ self._left
        ridge = 1e-12 * np.trace(normal) * np.eye(len(sized))
        sizes = np.linalg.lstsq(normal + ridge, slope, rcond=None)[0]
        kept = np.array(
            [np.clip(p.null + z, p.low, p.high) - p.null for p, z in zip(sized, sizes, strict=True)]
        )
        values = {p.name: float(p.null + z) for p, z in zip(sized, kept, strict=True)}
        return {**shape, **values}, float(2.0 * kept @ slope - kept @ normal @ kept)

    def scan(
        self, scanned: Sequence[Parameter], sized: Sequence[Parameter]
    ) -> tuple[dict[str, float], float, float]:
        """Try a grid of shapes; return the best, and the path that the unit column turns along."""
        grids = self._effect.grid([s.context for s in self._problem.stretches])
        axes = [np.clip(grids[p.name], p.low, p.high) for p in scanned]
        shapes = [
            {p.name: float(x) for p, x in zip(scanned, point, strict=True)}
            for point in product(*axes)
        ]
        best: tuple[dict[str, float], float] | None = None
        turned, before = 0.0, None
        for values, drop, column in self.best(shapes, sized):
            if best is None or drop > best[1]:
                best = (values, drop)
            size = float(np.linalg.norm(column))
            if size > 1e-9:
                unit = column / size
                if before is not None:
                    turned += math.acos(float(np.clip(abs(unit @ before), 0.0, 1.0)))
                before = unit
        if best is None:
            raise ValueError(f"{self._effect.name}: the grid of its scanned parameters is empty")
        return *best, turned

    def zoomed(
        self,
        best: tuple[dict[str, float], float],
        parameter: Parameter,
        axis: Array,
        scanned: Sequence[Parameter],
        sized: Sequence[Parameter],
    ) -> tuple[dict[str, float], float]:
        """Try ever finer values of one scanned parameter, the others held."""
        near = axis
        for _ in range(_ZOOM_ROUNDS):
            k = int(np.argmin(np.abs(near - best[0][parameter.name])))
            near = np.linspace(near[max(k - 1, 0)], near[min(k + 1, near.size - 1)], _ZOOM_POINTS)
            held = {p.name: best[0][p.name] for p in scanned}
            shapes = [{**held, parameter.name: float(value)} for value in near]
            for values, drop, _ in self.best(shapes, sized):
                if drop > best[1]:
                    best = (values, drop)
        return best


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
        change = self._problem.change_rad_s(self.applied(theta))
        return self._problem.residual - self._problem.carried(change)

    def jacobian(self, theta: Array, here: Array) -> Array:
        columns = []
        for k, p in enumerate(self.parameters):
            step = _STEP_SHARE * p.typical
            if theta[k] + step > p.high:
                step = -step
            moved = theta.copy()
            moved[k] += step
            columns.append((self.left(moved) - here) / step)
        return np.column_stack(columns)

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
