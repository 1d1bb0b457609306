"""The search for the shape of one effect: a grid of what shapes it, finer where it is best."""

import math
from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.fitting.shape_ratings import Rate, Rated, charged, matched, peaks
from usmbench.diagnose.fitting.weighed_shapes import WeighedShapes
from usmbench.model.effects.parameter import Parameter

Array = NDArray[np.float64]

_ZOOM_ROUNDS, _JAGGED_ROUNDS = 2, 5
_ZOOM_POINTS = 7
_PROBED, _SIGMAS = 16, 5.0  # one shape of so many is probed; deviations left to chance
_PATH_DENSER = 4  # than the grid, for how long a way all shapes are
_NEAR, _DENSER = 1.25, 10  # how far from the best value a jagged effect is tried so much denser


class ShapeSearch(WeighedShapes):
    """The same, searched for the best shape."""

    def scan(
        self, scanned: Sequence[Parameter], sized: Sequence[Parameter]
    ) -> tuple[dict[str, float], float, float]:
        """Try a grid of shapes; return the best, and the roughness that it is charged for.

        Parameters
        ----------
        scanned, sized
            The effect's parameters.
        """
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
        if self._effect.jagged and len(scanned) == 1:
            shapes = self._within_reach(shapes)
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

    def _within_reach(self, shapes: list[dict[str, float]]) -> list[dict[str, float]]:
        """Leave out stretches of a path along which nothing can lower the deviance.

        A change c lowers it by 2 e·c − c², e what is left: at most |c| (2 (|s| + z) − |c|), where
        |s|² is what is left beyond chance and z what chance brings along c.

        Parameters
        ----------
        shapes
            The path, of an effect that nothing sizes.
        """
        n = self._problem.n_rows
        deviance = float(self._left.products(self._left)[0, 0])
        beyond = max(deviance - n, 0.0) + _SIGMAS * math.sqrt(2.0 * n)
        reach = (2.0 * (math.sqrt(beyond) + _SIGMAS)) ** 2
        probes = shapes[::_PROBED]
        far = np.array([tried.square > reach for tried in self.best(probes, ())])
        left_out = np.repeat(far & np.append(far[1:], far[-1]), _PROBED)
        return [shape for shape, out in zip(shapes, left_out, strict=False) if not out] or probes

    def axes(self, scanned: Sequence[Parameter]) -> list[Array]:
        """Return the values at which each parameter is tried first.

        Parameters
        ----------
        scanned
            The parameters.
        """
        grids = self._effect.grid([s.context for s in self._problem.stretches])
        return [np.clip(grids[p.name], p.low, p.high) for p in scanned]

    def roughness(
        self, scanned: Sequence[Parameter], sized: Sequence[Parameter], statistic: float
    ) -> float:
        """Return what all shapes that a search may end at come to, in rad.

        Of one parameter that is the way that the change turns by along it, also between two shapes
        of the grid, where one that rings may turn many times. Of two, half the way round, and what
        the area between comes to at a statistic: the Euler characteristic of a Gaussian field
        (Adler and Taylor 2007, doi:10.1007/978-0-387-48116-6, section 11.7). The two are taken to
        turn it at right angles; where they do not, that is too much.

        Parameters
        ----------
        scanned
            One or two parameters that shape it.
        sized
            Those that size it.
        statistic
            Drop of the deviance that is asked about.
        """
        along, *others = scanned
        axis, *axes = self.axes(scanned)
        values = _denser(axis, _PATH_DENSER)
        held: list[dict[str, float]] = [{}]
        for p, grid in zip(others, axes, strict=True):
            held = [{p.name: float(x)} for x in np.unique(np.r_[p.low, grid, p.high])]
        shapes = [[{**row, along.name: float(x)} for x in values] for row in held]
        rows = self._turned(shapes, sized)
        columns = self._turned(list(zip(*shapes, strict=True)), sized).T
        # Cell by cell, each side by the mean of the two that lie opposite.
        beside, above = rows[1:] + rows[:-1], columns[:, 1:] + columns[:, :-1]
        area = float(np.sum(0.25 * beside * above))
        around = float(np.sum(rows[[0, -1]]) + np.sum(columns[:, [0, -1]]))
        return 0.5 * around + area * math.sqrt(max(statistic, 0.0) / (2.0 * math.pi))

    def _turned(
        self, shapes: Sequence[Sequence[dict[str, float]]], sized: Sequence[Parameter]
    ) -> Array:
        """Return the angle from each shape of a row to the next, in rad, shape (R, V − 1)."""
        return np.array([[t.turned for t in self.best(row, sized)][1:] for row in shapes])

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
            if near.size < 2:
                continue
            shapes = [{**best[0], p.name: float(x)} for x in _denser(near, _DENSER)]
            rated = [(t.values, matched(t.drop, t.square)) for t in self.best(shapes, ())]
            caught = self._caught(max(rated, key=lambda r: r[1]), scanned)
            best = max(best, caught, key=lambda r: r[1])
        return best

    def _caught(self, near: Rated, scanned: Sequence[Parameter]) -> Rated:
        """Close in on what the scan of a jagged effect came near; return the drop there."""
        for p, axis in zip(scanned, self.axes(scanned), strict=True):
            near = self.zoomed(near, p, axis, (), matched)
        return self.exactly(near[0], ())

    def zoomed(
        self,
        best: Rated,
        parameter: Parameter,
        axis: Array,
        sized: Sequence[Parameter],
        rate: Rate,
    ) -> Rated:
        """Try ever finer values of one scanned parameter, the others held.

        Parameters
        ----------
        best
            The best values so far, and what they are worth.
        parameter, axis
            The parameter, and the values at which it was tried, rising.
        sized
            Parameters that size the effect.
        rate
            What a drop is worth.
        """
        near = axis
        for _ in range(_JAGGED_ROUNDS if self._effect.jagged else _ZOOM_ROUNDS):
            k = int(np.argmin(np.abs(near - best[0][parameter.name])))
            near = np.linspace(near[max(k - 1, 0)], near[min(k + 1, near.size - 1)], _ZOOM_POINTS)
            held = {p.name: best[0][p.name] for p in self._effect.parameters if p.scanned}
            shapes = [{**held, parameter.name: float(value)} for value in near]
            for tried in self.best(shapes, sized):
                worth = rate(tried.drop, tried.square)
                if worth > best[1]:
                    best = (tried.values, worth)
        return best


def _denser(axis: Array, times: int) -> Array:
    """Return the values of an axis and evenly more between each two."""
    parts = np.linspace(0.0, axis.size - 1.0, times * (axis.size - 1) + 1)
    return np.interp(parts, np.arange(axis.size), axis)
