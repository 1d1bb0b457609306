"""Whether runs look as if their motor had been warm when they began, which no fault is.

Temperature is in no log. A motor that was driven a moment before has its warm-up behind it; what is
known of that says how it would look. Where it stands for names, runs are searched once more.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear
from scipy.stats import chi2

from usmbench.diagnose.known.warm_start import warm_means, warm_shapes
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.naming.ranking import NO_CHANCE, telling_deviance
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.extended import Applied

Array = NDArray[np.float64]

_PLAIN = 0.1  # of how warm driving makes a motor
_LARGELY = 0.5  # of what names explain


@dataclass(frozen=True, slots=True)
class WarmStart:
    """Runs that may have begun warm, and what a search made of them that takes them for cold.

    Parameters
    ----------
    cold
        What that search came to.
    problem
        Its problem of a motor that shows nothing of what it named.
    columns
        Change of speed where a run begins as warm as driving makes the motor, each run's at each
        thermal time constant, by stretch, shape (N, R C).
    carried
        The same as the problem carries residuals, shape (M, R C).
    """

    cold: Found
    problem: Problem
    columns: tuple[Array, ...]
    carried: Array

    @classmethod
    def of(cls, cold: Found) -> "WarmStart":
        """Return what a warm start would do in the runs of a search.

        Parameters
        ----------
        cold
            What the search came to.
        """
        problem = cold.without_names.problem
        columns = tuple(_columns(problem))
        return cls(cold, problem, columns, problem.carried(columns))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the runs that look warm; none where that stands for little of what is off.

        It is half of all that is off, or of one of the names, at least.
        """
        effects = self.cold.fit.effects
        if not np.any(self.carried):
            return ()
        for rest in ((), *_without_one(effects)):
            explained, shares = self._explains(rest)
            beyond = self._gained(rest, effects) if effects else self.cold.beyond_noise
            chance = chi2.sf(explained, shares.size)
            if chance < NO_CHANCE and explained > _LARGELY * beyond:
                return tuple(self._warm(shares))
        return ()

    def tells_more(self, warm: Found) -> bool:
        """Whether fewer names explain about as much beside a warm start, or as many explain more.

        Parameters
        ----------
        warm
            What a search came to that lets the runs begin warm.
        """
        before, now = self.cold.fit.effects, warm.fit.effects
        gained = self._gained((), before)
        more = self._gained((), now) + self._explains(now)[0] - gained
        if not before or len(now) < len(before):
            return more > -telling_deviance(gained)
        return len(now) == len(before) and more > 0.0

    def _explains(self, given: Sequence[Applied]) -> tuple[float, Array]:
        """Return what a warm start explains beside effects, and how warm each column says."""
        left = self.problem.left(given)
        # No motor begins colder than cold.
        fit = lsq_linear(self.carried, left, (0.0, 1.0))
        return (float(left @ left) - 2.0 * float(fit.cost)) / self.cold.spread**2, fit.x

    def _gained(self, rest: Sequence[Applied], effects: Sequence[Applied]) -> float:
        """Return what effects explain beyond some of them."""
        without, left = self.problem.left(rest), self.problem.left(effects)
        return float(without @ without - left @ left) / self.cold.spread**2

    def _warm(self, shares: Array) -> Iterator[str]:
        """Yield the runs of which the shares, by how much each changes the speed, are plain."""
        weights = np.sqrt(sum((c**2).sum(axis=0) for c in self.columns))
        runs = {s.run: s.name for s in self.problem.stretches}
        heavy, warm = (a.reshape(len(runs), -1).sum(axis=1) for a in (weights, weights * shares))
        for run, weight, size in zip(sorted(runs), heavy, warm, strict=True):
            if size > _PLAIN * weight:
                yield runs[run]


def warm_warnings(names: Sequence[str]) -> list[str]:
    """Say which runs look as if they had begun with a warm motor.

    Parameters
    ----------
    names
        Their names.
    """
    return [
        f"{name}: as if the motor had been warm when the run began, other than in the runs of the "
        "model; that is no news: let it cool before a run, or identify a model on runs that begin "
        "as warm"
        for name in names
    ]


def _without_one(effects: Sequence[Applied]) -> Iterator[tuple[Applied, ...]]:
    """Yield effects without one of them, each in turn; without the only one there are none."""
    if len(effects) > 1:
        yield from (tuple(a for a in effects if a is not one) for one in effects)


def _columns(problem: Problem) -> Iterator[Array]:
    """Yield what `WarmStart.columns` holds of each stretch."""
    known, runs = problem.known, sorted({s.run for s in problem.stretches})
    means = warm_means(known.features, known.mean)
    for s in problem.stretches:
        warm_rad_s = warm_shapes(s, known.features) @ means
        yield np.column_stack([warm_rad_s * (s.run == r) for r in runs])
