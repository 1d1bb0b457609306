"""The coefficients of what a model leaves, learnt from the runs that it was identified on.

They are estimated from all runs with priors (a ridge), weighted and whitened.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.wander_estimate import beside
from usmbench.diagnose.noise.noise_model import Noise
from usmbench.diagnose.noise.whitening import whitening

Array = NDArray[np.float64]

_ROUNDS = 3
_FOLDS, _BLOCK = 4, 100
_HUBER = 3.0
_TIED = 100.0  # weight with which the runs' own deviations add up to 0


@dataclass(frozen=True, slots=True)
class Learnt:
    """What runs teach.

    Parameters
    ----------
    mean
        Coefficient of each shape, shape (K,).
    runs
        What each run is off by on its own, in deviations, shape (R, O).
    gram, slope
        Normal equations of those, the shapes learnt beside them, shapes (R, O, R, O) and (R, O).
    folds
        Normal equations of all, in priors, of each fold, shapes (F, S, S) and (F, S).
    tied
        The sum of the folds' with the priors, shape (S, S).
    """

    mean: Array
    runs: Array
    gram: Array
    slope: Array
    folds: tuple[Array, Array]
    tied: Array


@dataclass(frozen=True, slots=True)
class _Part:
    """Whitened columns of one stretch on the rows that count, and where they belong."""

    run: int
    columns: Array
    error: Array
    fold: NDArray[np.intp]
    at: NDArray[np.intp]

    def rest(self, theta: Array) -> Array:
        """Return what coefficients leave of the error, shape (rows,)."""
        rest: Array = self.error - self.columns @ theta[self.at]
        return rest


def learn(
    features: Features,
    stretches: Sequence[Stretch],
    shapes: Sequence[Array],
    noise: Noise,
    masks: Sequence[Mask],
    own: Sequence[Array],
) -> Learnt:
    """Learn the shapes' coefficients.

    Parameters
    ----------
    features
        The family of shapes.
    stretches
        The runs.
    shapes
        Its columns on each, shape (N, K).
    noise
        The noise in force.
    masks
        Rows of each that count.
    own
        What each run may be off by on its own, of one standard deviation, shape (N, O).
    """
    prior, n_own = features.prior, own[0].shape[1]
    n_runs = 1 + max(s.run for s in stretches)
    size = prior.size + n_own * n_runs
    parts = _whitened(stretches, shapes, own, prior, noise, masks)
    ties = _ties(parts, n_runs, prior.size)
    theta = np.zeros(size)
    n_folds = n_runs if n_runs > 1 else _FOLDS
    whole = _moments(parts, (np.ones(p.error.size) for p in parts), size, n_folds)
    for _ in range(_ROUNDS):
        # Few rows are far out: cheaper to take these off again than to weigh all.
        far = _moments(parts, _far_shares(parts, theta), size, n_folds)
        grams, slopes = (all_rows - off for all_rows, off in zip(whole, far, strict=True))
        gram, slope = grams.sum(axis=0) + ties, slopes.sum(axis=0)
        theta = np.linalg.solve(gram, slope)
    runs = theta[prior.size :].reshape(n_runs, n_own)
    learnt = np.arange(size) < prior.size
    left, toward = beside(grams.sum(axis=0) + np.diag(learnt.astype(float)), slope, ~learnt)
    return Learnt(
        prior * theta[: prior.size],
        runs,
        left.reshape(runs.shape * 2),
        toward.reshape(runs.shape),
        (grams, slopes),
        gram,
    )


def _whitened(
    stretches: Sequence[Stretch],
    shapes: Sequence[Array],
    own: Sequence[Array],
    prior: Array,
    noise: Noise,
    masks: Sequence[Mask],
) -> list[_Part]:
    """Whiten shapes and what is a run's own, and say which coefficients they have."""
    n_shapes, n_own, lone = prior.size, own[0].shape[1], all(s.run == 0 for s in stretches)
    parts = []
    for s, shape, departed, mask in zip(stretches, shapes, own, masks, strict=True):
        white, both = whitening(noise, s)[mask], np.column_stack((shape * prior, departed))
        columns, error = (np.asarray(white @ part) for part in (both, s.residual_rad_s))
        fold = _block_of(mask) if lone else np.full(error.size, s.run)
        at = np.r_[:n_shapes, n_shapes + n_own * s.run + np.arange(n_own)]
        parts.append(_Part(s.run, columns, error, fold, at))
    return parts


def _ties(parts: Sequence[_Part], n_runs: int, n_shapes: int) -> Array:
    """Priors of all coefficients.

    What all runs have in common belongs to the model's error, which the shapes carry: their own
    add up to nothing, each by what it shows, else one that shows nothing would make up for others.
    """
    shown = np.zeros((n_runs, parts[0].columns.shape[1] - n_shapes))
    for part in parts:
        shown[part.run] += np.sum(part.columns[:, n_shapes:] ** 2, axis=0)
    shown /= np.maximum(shown.max(axis=0), 1e-300)
    common = _TIED * np.hstack([np.zeros((shown.shape[1], n_shapes)), *map(np.diag, shown)])
    return np.asarray(np.eye(common.shape[1]) + common.T @ common)


def _block_of(mask: Mask) -> NDArray[np.intp]:
    """Fold of each row that counts, of a run that is alone: blocks take turns, shape (rows,)."""
    block: NDArray[np.intp] = np.arange(mask.size)[mask] // _BLOCK % _FOLDS
    return block


def _far_shares(parts: Sequence[_Part], theta: Array) -> Iterator[Array]:
    """Yield the share by which each row does not count (Huber)."""
    for part in parts:
        size = np.maximum(np.abs(part.rest(theta)), 1e-12)
        yield 1.0 - np.minimum(1.0, _HUBER / size)


def _moments(
    parts: Sequence[_Part], shares: Iterator[Array], size: int, n_folds: int
) -> tuple[Array, Array]:
    """Return the weighed normal equations of each fold: a run each, or parts of a single one."""
    grams, slopes = np.zeros((n_folds, size, size)), np.zeros((n_folds, size))
    for part, share in zip(parts, shares, strict=True):
        for k in np.unique(part.fold):
            rows = (part.fold == k) & (share > 0.0)
            root = np.sqrt(share[rows])
            # A product with its own transpose takes half the time.
            weighed = part.columns[rows] * root[:, None]
            grams[k][np.ix_(part.at, part.at)] += weighed.T @ weighed
            slopes[k][part.at] += weighed.T @ (part.error[rows] * root)
    return grams, slopes
