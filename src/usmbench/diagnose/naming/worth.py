"""Whether what a further cause explains is worth a name."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.refining import refine_widely
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.views import omnibus
from usmbench.diagnose.residual.whole import whole_test
from usmbench.model.applied import Applied
from usmbench.model.effects.base import PHYSICS

Array = NDArray[np.float64]

# Where no other reason stands beside a threshold here, it was chosen while watching draws of
# simulated motors (docs/explanations/diagnosis.md), and no measurement fixes it.
# What a further cause has to bring in deviance though the form of those before it is in doubt: what
# patches bring, see "two causes" in benchmarks/naming_campaign.py, and a share of the first.
SECOND_LEAST, _SECOND_SHARE = 50.0, 3e-4
# And a share of the first, up to twice what patches bring: as much a large first misses at the
# edges of a dead zone.
_FIRST_SHARE, _FIRST_MOST = 0.01, 100.0
# Less is asked beside a small first that no other may stand for, where the doubt leaves it whole.
_CLEAR_LEAST = 20.0
# Of what it brings; a cause that keeps less looks like a misfit of those before it, and has to
# bring more than a form leaves that is off by as much as forms are.
_ITSELF = 0.9
_REST = 0.1  # of what the views show: beside a grid, a cause leaves no more of it
# Of what it takes from unseen blocks: what the form of a large first misses is in one fold of four.
_ONE_FOLD = 2.0 / 3.0
# Of what it takes from the other blocks: what makes one worse by more, and by more than patches
# bring, is not what is wrong there.
_WORSE = 0.1
# That a cause has to explain better: a handful of windows are accidents. Friction that sticks shows
# in a window or two at each of a few starts: three places (2.5, since they count by their weight).
_FEWEST_ROWS, _FEWEST_PLACES = 8.0, 2.5
# At the edge of the dead zone a rotor stays where it is all through one stay of the phase, on one
# day and not on another: a name rests on more.
_FEWEST_STAYS = 1.5  # one and part of another, by weight
_GAINED, _APART = 10.0, 5  # deviance of a row beyond chance; rows without between two places
# Deviance of what runs may be off by, ten of its deviations: a gain of −1 stands in no single row.
_OUT_OF_BOUNDS = 100.0
_MOST_OF_ROW = 100.0  # deviance: ten times the noise


@dataclass(frozen=True, slots=True)
class First:
    """The first cause, and those that have been named beside it.

    Parameters
    ----------
    evidence
        What they bring, in deviance over the noise's spread; 0 where there is none.
    rivals
        Causes that may stand for one of them: what is left is then what the two part in.
    """

    evidence: float = 0.0
    rivals: frozenset[str] = frozenset()


def worth_a_name(
    problem: Problem, before: Fit, longer: Fit, unseen: Array, first: First, spread: float
) -> bool:
    """Return whether what a further cause explains is worth a name.

    Parameters
    ----------
    problem
        The problem.
    before, longer
        The fits without it and with it, the last of the effects.
    unseen
        Deviance that it takes from blocks that its fit has not seen, by fold, shape (F,).
    first
        The first cause.
    spread
        Standard deviation of the whitened noise, at least 1.
    """
    taken, most = float(np.sum(unseen)), float(np.max(unseen))
    # One block alone may be an accident.
    if min(taken, taken - most) <= 0.0:
        return False
    worse = -float(np.min(unseen))
    if worse > max(_WORSE * (taken + worse), SECOND_LEAST):
        return False
    if before.effects and most > _ONE_FOLD * taken:
        return False
    if before.effects and not _beyond_form(problem, before, longer, first, spread):
        return False
    if _stays(problem, before, longer) < _FEWEST_STAYS:
        return False
    gained = _by_row(problem, before, longer)
    in_rows = float(np.sum(gained))
    if not before.effects and longer.statistic - in_rows > max(in_rows, _OUT_OF_BOUNDS):
        return True
    return _effective(gained) >= _FEWEST_ROWS or _places(problem, gained) >= _FEWEST_PLACES


def _beyond_form(problem: Problem, before: Fit, longer: Fit, first: First, spread: float) -> bool:
    """Whether the last of the effects brings more than the others' form may be off by.

    Where these are others than before, each of them has to.
    """
    same = [a.effect for a in before.effects] == [a.effect for a in longer.effects[:-1]]
    if same:
        return earns_its_place(problem, before.effects, longer.effects, first, spread)
    for k in range(len(longer.effects)):
        rest = replace(longer, effects=longer.effects[:k] + longer.effects[k + 1 :])
        others = refine_widely(problem, rest).effects
        if not earns_its_place(problem, others, longer.effects, first, spread):
            return False
    return True


def earns_its_place(
    problem: Problem,
    others: Sequence[Applied],
    together: Sequence[Applied],
    first: First,
    spread: float,
) -> bool:
    """Return whether causes bring more than the form of others may be off by.

    Parameters
    ----------
    problem
        The problem.
    others, together
        The causes that they have to explain more than, and all that are weighed.
    first
        The first cause.
    spread
        Standard deviation of the whitened noise, at least 1.
    """
    off = _form_off(others, together, first)
    whole = (problem, problem.doubting(others, off))
    brings, kept = (_gained(p, others, together) / spread**2 for p in whole)
    itself = kept > _ITSELF * brings
    # What is jagged is off where no smooth doubt covers it: at the phases that it leads to.
    smooth = not any(applied.effect.jagged for applied in others)
    apart = itself and (smooth or _takes_the_rest(problem, others, together, spread))
    share = _SECOND_SHARE if apart else off**2
    least = _CLEAR_LEAST if itself and not first.rivals else SECOND_LEAST
    missed = min(_FIRST_SHARE * first.evidence, _FIRST_MOST)
    least = max(least, missed, _SECOND_SHARE * first.evidence)
    return kept >= least and brings >= share * first.evidence


def _form_off(others: Sequence[Applied], together: Sequence[Applied], first: First) -> float:
    """Share of themselves by which the form of the others may be off.

    Where a cause that is not among them may stand for one of them, its form is what counts.
    """
    if not first.rivals <= {applied.effect.name for applied in together}:
        return PHYSICS
    return max(applied.effect.form_off for applied in others)


def _takes_the_rest(
    problem: Problem, others: Sequence[Applied], together: Sequence[Applied], spread: float
) -> bool:
    """Whether the last effect takes what the views show of what the others leave."""
    basis = omnibus(problem)
    left, after = (whole_test(problem, basis, e, spread).excess for e in (others, together))
    return after < _REST * left


def _gained(problem: Problem, before: Sequence[Applied], after: Sequence[Applied]) -> float:
    """Deviance that more causes take from a problem."""
    fewer, more = problem.left(before), problem.left(after)
    return float(fewer @ fewer - more @ more)


def _by_row(problem: Problem, before: Fit, longer: Fit) -> Array:
    """Deviance that more causes take from each row that counts, shape (N,)."""
    fewer, more = (problem.left(f.effects)[: problem.n_rows] ** 2 for f in (before, longer))
    return np.asarray(np.clip(fewer - more, 0.0, _most_of_one(longer)))


def _most_of_one(longer: Fit) -> float:
    """Most of the deviance of a row, or of a stay, that counts.

    What acts by chance strikes some rows far harder than others, which speaks not against them.
    """
    return _MOST_OF_ROW if longer.effects[-1].effect.by_chance else np.inf


def _effective(gained: Array) -> float:
    """Effective number of rows behind a gain: (Σd)²/Σd²."""
    return float(np.sum(gained) ** 2 / max(float(np.sum(gained**2)), 1e-300))


def _stays(problem: Problem, before: Fit, longer: Fit) -> float:
    """Effective number of stays of the phase at which more causes explain more.

    Whether what is no news may depart in their place, or not.
    """
    fewer, more = (problem.left_rad_s(f.effects) for f in (before, longer))
    gained = [
        np.maximum((b**2 - a**2) / problem.noise.level_rad_s(s) ** 2, 0.0) * mask
        for b, a, s, mask in zip(fewer, more, problem.stretches, problem.masks, strict=True)
    ]
    begins = np.concatenate([s.lag == 0 for s in problem.stretches])
    by_stay = np.bincount(np.cumsum(begins), weights=np.concatenate(gained))
    return _effective(np.minimum(by_stay, _most_of_one(longer)))


def _places(problem: Problem, gained: Array) -> float:
    """Effective number of places behind a gain: rows that lie together, none of them a giant."""
    rows = np.flatnonzero(np.concatenate(problem.valid))[gained > _GAINED]
    place = np.cumsum(np.diff(rows, prepend=rows[:1]) > _APART)
    sums = np.bincount(place, weights=gained[gained > _GAINED])
    return _effective(np.minimum(sums, _MOST_OF_ROW))
