"""Whether runs began with a warm motor, by their look, which no fault is.

Temperature is in no log. A motor that was driven a moment before has its warm-up behind it; what is
known of that says how it would look. Where it stands for names, runs are searched once more.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import compress

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from usmbench.diagnose.known.warm_start_shapes import histories, warm_means, warm_shapes
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.naming.ranking import NO_CHANCE, TELLING
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied

Array = NDArray[np.float64]

_PLAIN = 0.1  # of how warm driving makes a motor
_LARGELY = 0.5  # of what names explain
_FREE = 3  # of each run: how warm it is, how long it was driven before, and then stood


@dataclass(frozen=True, slots=True)
class WarmStart:
    """Runs that may have begun warm, and what a search made of them that takes them for cold.

    Parameters
    ----------
    cold
        What that search came to.
    problem
        Its problem of a motor that shows nothing of what it named.
    carried
        Change of speed where a run begins as warm as driving makes the motor, each run's at each
        thermal time constant, as the problem carries residuals, shape (M, R C).
    """

    cold: Found
    problem: Problem
    carried: Array

    @classmethod
    def of(cls, cold: Found) -> "WarmStart":
        """Return what a warm start would do in the runs of a search.

        Parameters
        ----------
        cold
            What the search came to.
        """
        problem = cold.drop_names().problem
        return cls(cold, problem, problem.carried(list(_columns(problem))))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the runs that look warm.

        Empty where that stands for less than half of all that is off, and of each name.
        """
        effects, runs = self.cold.fit.effects, {s.run: s.name for s in self.problem.stretches}
        if not np.any(self.carried):
            return ()
        for rest in ((), *_without_one(effects)):
            explained, shares = self._explains(rest)
            beyond = self._gained(rest, effects) if effects else self.cold.beyond_noise
            chance = chi2.sf(explained, _FREE * len(runs))
            if chance < NO_CHANCE and explained > _LARGELY * beyond:
                warm = (float(np.max(share)) > _PLAIN for share in shares)
                return tuple(compress((runs[r] for r in sorted(runs)), warm))
        return ()

    def tells_more(self, warm: Found) -> bool:
        """Whether names beside a warm start explain more than those without it.

        Each name has its price: what tells two causes apart at least.

        Parameters
        ----------
        warm
            What a search came to that lets the runs begin warm.
        """
        before, now = self.cold.fit.effects, warm.fit.effects
        more = self._gained(before, now) + self._explains(now)[0]
        return not before or more > TELLING * (len(now) - len(before))

    def _explains(self, given: Sequence[Applied]) -> tuple[float, list[Array]]:
        """Return what a warm start explains beside effects, and how warm each run is, (C,)."""
        left, explained = self.problem.left(given), 0.0
        shares: list[Array] = []
        may_be = histories(self.problem.known.features.n_constants)
        for carried in np.split(self.carried, self.carried.shape[1] // may_be.shape[1], axis=1):
            shown = carried @ may_be.T
            along, power = shown.T @ left, np.maximum(np.sum(shown**2, axis=0), 1e-300)
            # No motor begins colder than cold.
            size = np.clip(along / power, 0.0, 1.0)
            drops = size * (2.0 * along - size * power)
            best = int(np.argmax(drops))
            left = left - size[best] * shown[:, best]
            explained += float(drops[best])
            shares.append(size[best] * may_be[best])
        return explained / self.cold.spread**2, shares

    def _gained(self, rest: Sequence[Applied], effects: Sequence[Applied]) -> float:
        """Return what effects explain beyond others."""
        without, left = self.problem.left(rest), self.problem.left(effects)
        return float(without @ without - left @ left) / self.cold.spread**2


def warm_warnings(names: Sequence[str], if_cold: Sequence[str]) -> list[str]:
    """Say which runs look as if they had begun with a warm motor.

    Parameters
    ----------
    names
        Their names.
    if_cold
        Names of causes that would stand if they had not.
    """
    otherwise = f"; if it was cold, {' and '.join(if_cold)} would stand" if if_cold else ""
    return [
        f"{name}: as if the motor had been warm when the run began, other than in the runs of the "
        "model; that is no news: let it cool before a run, or identify a model on runs that begin "
        f"as warm{otherwise}"
        for name in names
    ]


def _without_one(effects: Sequence[Applied]) -> Iterator[tuple[Applied, ...]]:
    """Yield effects without one of them, each in turn; without the only one there are none."""
    if len(effects) > 1:
        yield from (tuple(a for a in effects if a is not one) for one in effects)


def _columns(problem: Problem) -> Iterator[Array]:
    """Yield the change of speed on each stretch, shape (N, R C)."""
    known, runs = problem.known, sorted({s.run for s in problem.stretches})
    means = warm_means(known.features, known.mean)
    for s in problem.stretches:
        warm_rad_s = warm_shapes(s, known.features) @ means
        yield np.column_stack([warm_rad_s * (s.run == r) for r in runs])
