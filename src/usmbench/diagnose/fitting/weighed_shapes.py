"""Shapes of one effect, each at its best sizes to first order."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.fitting.shape_ratings import Rated
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Effect
from usmbench.model.effects.parameter import Parameter
from usmbench.model.extended import moving_starts

Array = NDArray[np.float64]

_AT_ONCE = 32  # shapes weighed together
_NOTHING = 1e-18  # deviance of a change that is none
_SLIGHT = 0.1  # of the speed: beside what changes less, another cause does what it does alone


@dataclass(frozen=True, slots=True)
class Tried:
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


def _angle_rad(square: float, other: float, product: float) -> float:
    """Angle between two changes whichever way they point, by their products; of none 0."""
    sizes = math.sqrt(max(other, 0.0) * square)
    return 0.0 if sizes <= _NOTHING else math.acos(min(abs(product) / sizes, 1.0))


def _solved(normal: Array, slope: Array) -> list[float]:
    """Return the sizes of least deviance; of what changes nothing 0."""
    if slope.size == 1:  # most effects, thousands of times
        return [float(slope[0] / normal[0, 0])] if normal[0, 0] > 0.0 else [0.0]
    ridge = 1e-12 * np.trace(normal) * np.eye(slope.size)
    sizes: list[float] = np.linalg.lstsq(normal + ridge, slope, rcond=None)[0].tolist()
    return sizes


class WeighedShapes:
    """One effect beside fixed ones, in shapes that are given.

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
        self._left = problem.pulled(np.concatenate(problem.left_rad_s(given))[:, None])
        self._simulated_rad_s = np.concatenate([s.simulated_rad_s for s in problem.stretches])
        self._before_rad_s = self._simulated_rad_s
        if given:
            self._before_rad_s = problem.speeds_rad_s([given])[:, 0]

    def _beside_little(self) -> bool:
        """Whether the effects given change the speed so little that each acts as if alone."""
        if not self._given or self._starts_elsewhere():
            return False
        changed = np.linalg.norm(self._before_rad_s - self._simulated_rad_s)
        return bool(changed < _SLIGHT * np.linalg.norm(self._simulated_rad_s))

    def _starts_elsewhere(self) -> bool:
        """Whether it begins at some phase, and those given move the phase that is set."""
        begins = all(p.scanned for p in self._effect.parameters)
        return begins and self._effect.stage == "settled" and bool(moving_starts(self._given))

    def changes_rad_s(self, points: Sequence[Mapping[str, float]], *, alone: bool = False) -> Array:
        """Return the changes that the effect makes at each point, shape (N, M).

        What it makes of a run without those given is at hand where it was scanned before.

        Parameters
        ----------
        points
            M values of all its parameters.
        alone
            Whether to take those given away.
        """
        given, without = ((), self._simulated_rad_s) if alone else (self._given, self._before_rad_s)
        motors = [(*given, Applied(self._effect, values)) for values in points]
        changes: Array = self._problem.speeds_rad_s(motors) - without[:, None]
        return changes

    def best(
        self,
        shapes: Sequence[Mapping[str, float]],
        sized: Sequence[Parameter],
        *,
        alone: bool = False,
    ) -> Iterator[Tried]:
        """Yield each shape at its best sizes.

        Parameters
        ----------
        shapes
            Values of what is scanned.
        sized
            Parameters that size the effect.
        alone
            As in `changes_rad_s`.
        """
        nulls, each = {q.name: q.null for q in sized}, max(len(sized), 1)
        last, last_square = self._left, 0.0
        for at in range(0, len(shapes), _AT_ONCE):
            chunk = shapes[at : at + _AT_ONCE]
            points = [
                {**shape, **nulls, p.name: p.null + p.typical} for shape in chunk for p in sized
            ]
            changed = self._problem.pulled(self.changes_rad_s(points or chunk, alone=alone))
            per = np.array(([p.typical for p in sized] or [1.0]) * len(chunk))
            products = changed.products(changed) / np.outer(per, per)
            slopes = changed.products(self._left)[:, 0] / per
            # The last one, too, was a change by the first size's typical value.
            beside, latest = changed.products(last)[:, 0] / (per * per[0]), None
            for k, shape in enumerate(chunk):
                own = slice(k * each, (k + 1) * each)
                normal, first = products[own, own], own.start
                square, turned = float(normal[0, 0]), 0.0
                if square > _NOTHING:
                    turned = _angle_rad(square, last_square, beside[first])
                    beside, last_square, latest = products[:, first], square, first
                yield Tried(*self._sized(shape, sized, normal, slopes[own]), square, turned)
            if latest is not None:
                last = changed.one(latest)

    def _sized(
        self, shape: Mapping[str, float], sized: Sequence[Parameter], normal: Array, slope: Array
    ) -> Rated:
        """Return the best sizes at fixed shape, to first order, and the drop they bring."""
        if not sized:
            return dict(shape), float(2.0 * slope[0] - normal[0, 0])
        pairs = list(zip(sized, _solved(normal, slope), strict=True))
        kept = np.array([min(max(p.null + z, p.low), p.high) - p.null for p, z in pairs])
        values = {p.name: float(p.null + z) for p, z in zip(sized, kept, strict=True)}
        return {**shape, **values}, float(2.0 * kept @ slope - kept @ normal @ kept)

    def exactly(self, shape: Mapping[str, float], sized: Sequence[Parameter]) -> Rated:
        """Return the best values at one shape beside what is given, and the drop they bring.

        Parameters
        ----------
        shape
            Values of what is scanned.
        sized
            Parameters that size the effect.
        """
        (tried,) = self.best([shape], sized)
        return tried.values, tried.drop
