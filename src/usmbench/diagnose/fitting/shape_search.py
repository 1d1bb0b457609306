"""The search for the shape of one effect: a grid of what shapes it, its sizes to first order."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.fitting.shape_ratings import Rate, Rated, charged, matched, peaks
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.effects.base import Effect
from usmbench.model.effects.parameter import Parameter
from usmbench.model.extended import Applied

Array = NDArray[np.float64]

_ZOOM_ROUNDS, _JAGGED_ROUNDS = 2, 5
_ZOOM_POINTS = 7
_NEAR, _DENSER = 1.25, 10  # how far from the best value a jagged effect is tried so much denser
_AT_ONCE = 32  # shapes weighed together
_NOTHING = 1e-18  # deviance of a change that is none
_SLIGHT = 0.1  # of the speed: beside what changes less, another cause does what it does alone


@dataclass(frozen=True, slots=True)
class _Tried:
    """A shape at its best sizes.

    Parameters
    ----------
    values
        Shape and sizes.
    drop
        Drop of the deviance that they bring.
    square
        Deviance of the change that the first size makes by 1, or of the change where none sizes it.
    turned
        Angle between this change and the last one of any size, in rad.
    """

    values: dict[str, float]
    drop: float
    square: float
    turned: float


def _angle_rad(products: Array, one: int, other: int) -> float:
    """Angle between two changes whichever way they point, by their products; of none 0."""
    sizes = math.sqrt(max(products[one, one], 0.0) * products[other, other])
    return 0.0 if sizes <= _NOTHING else math.acos(min(abs(products[one, other]) / sizes, 1.0))


class ShapeSearch:
    """One effect beside fixed ones.

    Parameters
    ----------
    problem
        The problem.
    effect
        The effect.
    given
        Effects that are held where they are.
    """

    def __init__(self, problem: Problem, effect: Effect, given: tuple[Applied, ...]):
        self._problem, self._effect, self._given = problem, effect, given
        self._base = problem.change_rad_s(given) if given else None
        self._left = problem.left_rad_s(given)

    def _beside_little(self) -> bool:
        """Whether the effects given change the speed so little that each acts as if alone."""
        if self._base is None:
            return False
        speeds = [s.simulated_rad_s for s in self._problem.stretches]
        changed, all_of_it = (np.linalg.norm(np.concatenate(x)) for x in (self._base, speeds))
        return bool(changed < _SLIGHT * all_of_it)

    def changes(
        self, points: Sequence[Mapping[str, float]], *, alone: bool = False
    ) -> list[list[Array]]:
        """Return the changes that the effect makes at each point, by stretch, shape (N,) each.

        What it makes of a run without those given is at hand where it was scanned before.
        """
        given, base = ((), None) if alone else (self._given, self._base)
        changes = [
            self._problem.change_rad_s((*given, Applied(self._effect, values))) for values in points
        ]
        if base is None:
            return changes
        return [[c - b for c, b in zip(change, base, strict=True)] for change in changes]

    def best(
        self,
        shapes: Sequence[Mapping[str, float]],
        sized: Sequence[Parameter],
        *,
        alone: bool = False,
    ) -> Iterator[_Tried]:
        """Yield each shape at its best sizes."""
        nulls, each = {q.name: q.null for q in sized}, max(len(sized), 1)
        last = [np.zeros_like(left) for left in self._left]
        for at in range(0, len(shapes), _AT_ONCE):
            chunk = shapes[at : at + _AT_ONCE]
            points = [
                {**shape, **nulls, p.name: p.null + p.typical} for shape in chunk for p in sized
            ]
            changes = self.changes(points or chunk, alone=alone)
            products = self._problem.products([self._left, last, *changes])
            per = np.array([1.0, 1.0, *([p.typical for p in sized] or [1.0]) * len(chunk)])
            products /= np.outer(per, per)
            before = 1
            for k, shape in enumerate(chunk):
                own = slice(2 + k * each, 2 + (k + 1) * each)
                normal, slope = products[own, own], products[own, 0]
                square, turned = float(normal[0, 0]), 0.0
                if square > _NOTHING:
                    turned = _angle_rad(products, before, own.start)
                    before, last = own.start, changes[k * each]
                yield _Tried(*self._sized(shape, sized, normal, slope), square, turned)

    def _sized(
        self, shape: Mapping[str, float], sized: Sequence[Parameter], normal: Array, slope: Array
    ) -> Rated:
        """Return the best sizes at fixed shape, to first order, and the drop they bring."""
        if not sized:
            return dict(shape), float(2.0 * slope[0] - normal[0, 0])
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
        """Try a grid of shapes; return the best, and the roughness that it is charged for."""
        if not self._effect.apart:
            return self._scan(scanned, sized, {})
        nulls = {p.name: p.null for p in scanned}
        alone = [self._scan([p], sized, nulls) for p in scanned]
        shape = {p.name: one[0][p.name] for p, one in zip(scanned, alone, strict=True)}
        return *self.exactly(shape, sized), sum(roughness for *_, roughness in alone)

    def _scan(
        self,
        scanned: Sequence[Parameter],
        sized: Sequence[Parameter],
        others: Mapping[str, float],
    ) -> tuple[dict[str, float], float, float]:
        """Try a grid of shapes, other parameters held."""
        shapes = [
            {**others, **{p.name: float(x) for p, x in zip(scanned, point, strict=True)}}
            for point in product(*self.axes(scanned))
        ]
        best: Rated | None = None
        near: list[Rated] = []
        turned, reached = 0.0, 0.0
        alone = self._beside_little()
        for tried in self.best(shapes, sized, alone=alone):
            turned += tried.turned
            if best is None or tried.drop > best[1]:
                best, reached = (tried.values, tried.drop), turned
            if self._effect.jagged:
                near.append((tried.values, matched(tried.drop, tried.square)))
        if best is None:
            raise ValueError(f"{self._effect.name}: the grid of its scanned parameters is empty")
        if alone:
            held = [*others, *(p.name for p in scanned)]
            best = self.exactly({name: best[0][name] for name in held}, sized)
        caught = [self._caught(peak, scanned) for peak in peaks(near)]
        best = max([best, *caught], key=lambda found: found[1])
        if sized or self._effect.jagged:
            return *best, turned
        return *best, charged(turned, reached)

    def axes(self, scanned: Sequence[Parameter]) -> list[Array]:
        """Return the values at which each parameter is tried first."""
        grids = self._effect.grid([s.context for s in self._problem.stretches])
        return [np.clip(grids[p.name], p.low, p.high) for p in scanned]

    def closely(self, best: Rated, scanned: Sequence[Parameter]) -> Rated:
        """Try a jagged effect densely near its best values; return the best, and the drop there.

        On a peak of its own that the scan has stepped over it may bring far more.

        Parameters
        ----------
        best
            The best values so far, and the drop there.
        scanned
            Its parameters.
        """
        for p, axis in zip(scanned, self.axes(scanned), strict=True):
            value = best[0][p.name]
            near = axis[(axis > value / _NEAR) & (axis < value * _NEAR)]
            dense = np.interp(np.arange(0.0, near.size, 1.0 / _DENSER), np.arange(near.size), near)
            shapes = [{**best[0], p.name: float(x)} for x in dense]
            rated = [(t.values, matched(t.drop, t.square)) for t in self.best(shapes, ())]
            caught = self._caught(max(rated, key=lambda r: r[1]), scanned)
            best = max(best, caught, key=lambda r: r[1])
        return best

    def _caught(self, near: Rated, scanned: Sequence[Parameter]) -> Rated:
        """Close in on what the scan of a jagged effect came near; return the drop there."""
        for p, axis in zip(scanned, self.axes(scanned), strict=True):
            near = self.zoomed(near, p, axis, scanned, (), matched)
        return self.exactly(near[0], ())

    def exactly(self, shape: Mapping[str, float], sized: Sequence[Parameter]) -> Rated:
        """Return the best values at one shape beside what is given, and the drop they bring."""
        (tried,) = self.best([shape], sized)
        return tried.values, tried.drop

    def zoomed(
        self,
        best: Rated,
        parameter: Parameter,
        axis: Array,
        scanned: Sequence[Parameter],
        sized: Sequence[Parameter],
        rate: Rate,
    ) -> Rated:
        """Try ever finer values of one scanned parameter, the others held."""
        near = axis
        for _ in range(_JAGGED_ROUNDS if self._effect.jagged else _ZOOM_ROUNDS):
            k = int(np.argmin(np.abs(near - best[0][parameter.name])))
            near = np.linspace(near[max(k - 1, 0)], near[min(k + 1, near.size - 1)], _ZOOM_POINTS)
            held = {p.name: best[0][p.name] for p in scanned}
            shapes = [{**held, parameter.name: float(value)} for value in near]
            for tried in self.best(shapes, sized):
                worth = rate(tried.drop, tried.square)
                if worth > best[1]:
                    best = (tried.values, worth)
        return best
