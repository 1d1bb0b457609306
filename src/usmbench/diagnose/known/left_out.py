"""How far a run may be from what others teach, as leaving out one run at a time shows.

It is the estimate's own error, and what is beyond it: a moment estimate for each group of shapes,
then one factor on all variances.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.learning import Learnt
from usmbench.diagnose.known.wander_estimate import beside

Array = NDArray[np.float64]

# Of the prior's variance, what the others teach; of what they leave open, what a run left out
# shows; and a few rows that stand out.
_TAUGHT, _SHOWN, _OUTLYING = 0.5, 0.5, 16.0
_CHANCE = 1.0  # standard deviations by which chance alone lets folds differ


def covariance_root(features: Features, learnt: Learnt) -> Array:
    """Return a square root of the covariance of how far a run may be from what is learnt.

    Parameters
    ----------
    features
        The family of shapes.
    learnt
        What runs teach of them.

    Returns
    -------
    Array
        Shape (K, K).
    """
    prior = features.prior
    covariance = np.linalg.inv(learnt.tied)[: prior.size, : prior.size]
    extra = _between(features.groups, *learnt.folds)
    beyond = _beyond(extra, *learnt.folds)
    root = np.linalg.cholesky(covariance + np.diag(extra**2))
    return np.asarray(np.sqrt(beyond) * prior[:, None] * root)


def _left_out(grams: Array, slopes: Array) -> Iterator[tuple[Array, Array, Array]]:
    """Yield each fold's gram, the covariance that the others leave, and the score beyond them."""
    total, slope = grams.sum(axis=0) + np.eye(grams.shape[1]), slopes.sum(axis=0)
    for gram, own in zip(grams, slopes, strict=True):
        covariance = np.linalg.inv(total - gram)
        yield gram, covariance, own - gram @ (covariance @ (slope - own))


def _between(groups: Sequence[str], grams: Array, slopes: Array) -> Array:
    """Deviation of a fold's coefficients beyond their error, in priors, by group.

    With b₋ from the other folds and its covariance C, the score u = Xᵀ(y − X b₋) of the fold left
    out has the covariance G + G C G + τ² G_g G_gᵀ for the group's columns; the trace gives τ².
    """
    names = np.array(groups)
    extra = np.zeros(names.size)
    above = {g: [0.0, 0.0, 0.0] for g in dict.fromkeys(groups)}
    for gram, covariance, score in _left_out(grams, slopes):
        for g, sums in above.items():
            at = np.flatnonzero(names == g)
            block = gram[:, at]
            # Columns that the fold hardly excites say nothing: weigh by what they hold.
            null = block[at] + block.T @ covariance @ block
            sums[0] += float(score[at] @ score[at]) - float(np.trace(null))
            sums[1] += float(np.sum(block[at] ** 2))
            sums[2] += 2.0 * float(np.sum(null**2))
    for g, (excess, scale, variance) in above.items():
        if excess > _CHANCE * np.sqrt(variance):
            extra[names == g] = np.sqrt(excess / scale)
    return extra


def _beyond(extra: Array, grams: Array, slopes: Array) -> float:
    """Return how many times the variance of what is learnt is larger than it says, at least 1.

    A fold left out departs by d from what the others teach, in standard deviations, along each
    direction of which it shows p times as much as they leave open: d² is (1 + s p) / (1 + p) on
    average. What they hardly teach is learnt beside it: that its prior is wide says nothing of s.
    """
    more = np.zeros(grams.shape[1])
    more[: extra.size] = extra**2
    found = expected = 0.0
    for gram, covariance, score in _left_out(grams, slopes):
        variance, axes = eigh(covariance + np.diag(more))
        taught = variance < _TAUGHT
        unknown = np.diag(np.where(taught, 0.0, 1.0 / variance))
        left, toward = beside(axes.T @ gram @ axes + unknown, axes.T @ score, taught)
        unit = np.sqrt(variance[taught])
        power, ways = eigh(unit[:, None] * left * unit)
        shown = power > _SHOWN
        power = power[shown]
        square = (ways[:, shown].T @ (unit * toward)) ** 2 / (power * (1.0 + power))
        found += float(np.sum(np.minimum(square, _OUTLYING) - 1.0 / (1.0 + power)))
        expected += float(np.sum(power / (1.0 + power)))
    return max(found / max(expected, 1e-12), 1.0)
