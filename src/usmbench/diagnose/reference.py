"""What the runs that a model was identified on teach about judging others.

The shapes' coefficients are estimated from all runs with priors (a ridge), weighted and whitened.
How far another run may be from them is the estimate's own error, and what leaving out one run at a
time shows beyond it: a moment estimate for each group of shapes.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cut_runs import cut_runs
from usmbench.diagnose.features import Features
from usmbench.diagnose.features_of_runs import features_of
from usmbench.diagnose.knowledge import KEY, Knowledge
from usmbench.diagnose.naming import rank
from usmbench.diagnose.noise import Noise
from usmbench.diagnose.noise_estimate import estimate_noise
from usmbench.diagnose.problem import Problem
from usmbench.diagnose.spikes import PLAIN, count_steady, off_steps, spiked
from usmbench.diagnose.stretches import Mask, Stretch
from usmbench.diagnose.wander import (
    ANY,
    LEAST,
    departures,
    wander_of_shares,
)
from usmbench.diagnose.wander_estimate import beside, measured_wander
from usmbench.diagnose.whitening import whitening
from usmbench.errors import InputError
from usmbench.model.effects.base import Stage
from usmbench.model.effects.registry import library
from usmbench.model.extended import Applied
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record

Array = NDArray[np.float64]
Part = tuple[Stretch, Array, Array, Mask]  # whitened shapes and error on the rows that count

_ROUNDS = 3
_FOLDS, _BLOCK = 4, 100
_HUBER = 3.0
_MANY_ROWS = 3000
_TIED = 100.0  # weight with which the runs' own deviations add up to 0
_CHANCE = 1.0  # standard deviations by which chance alone lets folds differ
_PLAIN = 30.0  # a deviance that no chance explains


def with_knowledge(model: HammersteinModel, records: Sequence[Record]) -> HammersteinModel:
    """Return a model that carries what the runs it was identified on show.

    Parameters
    ----------
    model
        The identified model.
    records
        Those runs. Runs whose windows the model does not describe (a list of settled pairs, a
        handful of rows) leave the model as it is.
    """
    try:
        stretches, _ = cut_runs(records, model, ())
    except InputError:
        return model
    known = measure_knowledge(stretches)
    habits: tuple[Applied, ...] = ()
    stages: tuple[Stage, ...] = ("command", "settled")
    for stage in stages:
        # The shapes that are known would hide what a curve cannot be, and need not share it.
        without = known if stage == "command" else known.nothing
        found = _habit(stretches, without, habits, stage)
        if found:
            habits += found
            stretches, _ = cut_runs(records, model, habits)
            known = measure_knowledge(stretches, habits)
    return replace(model, residual={**model.residual, KEY: known.to_mapping()})


def _habit(
    stretches: Sequence[Stretch], known: Knowledge, own: Sequence[Applied], stage: Stage
) -> tuple[Applied, ...]:
    """Return what healthy runs plainly show at a stage, beyond what is known."""
    contexts = [s.context for s in stretches]
    effects = [e for e in library() if e.stage == stage and e.habitual(contexts)]
    if known.noise is None or not effects:
        return ()
    problem = Problem(stretches, known, known.noise, [s.use for s in stretches], own)
    best = rank(problem, effects, 1.0)[0]
    return best.fit.effects if best.statistic > _PLAIN else ()


def measure_knowledge(stretches: Sequence[Stretch], habits: Sequence[Applied] = ()) -> Knowledge:
    """Measure noise, known misfit and repeatability.

    Parameters
    ----------
    stretches
        The runs that the model was identified on.
    habits
        What they show anyhow, with which they were cut.
    """
    features = features_of(stretches)
    residuals = [s.residual_rad_s for s in stretches]
    uses = [s.use for s in stretches]
    fitted = _fitted(features, stretches)
    noise = estimate_noise(stretches, residuals, uses, fitted)
    left, masks = residuals, uses
    mean, root = np.zeros_like(features.prior), np.zeros((0, 0))
    widest, least = (
        wander_of_shares(shares, features.top_rad_s, features.n_points, features.n_places)
        for shares in (ANY, LEAST)
    )
    wander = widest
    for _ in range(_ROUNDS):
        far = spiked(stretches, left, noise, near_steps=True)
        masks = [use & ~f for use, f in zip(uses, far, strict=True)]
        warms = np.where(features.warms, mean, 0.0)
        own = [
            departures(s, features.warming(s, features.combined(s, warms)), habits)
            * wander.deviations
            for s in stretches
        ]
        mean, root, runs, (gram, slope) = _learn(features, stretches, noise, masks, own)
        left = [
            r - features.combined(s, mean) - o @ runs[s.run]
            for s, r, o in zip(stretches, residuals, own, strict=True)
        ]
        unit = wander.deviations
        wander = measured_wander(widest, least, gram / unit[:, None, None] / unit, slope / unit)
        noise = estimate_noise(stretches, left, masks, fitted)
    far = spiked(stretches, left, noise, near_steps=True, times=PLAIN)
    far = off_steps(stretches, left, far)
    n_spikes, n_steady = count_steady(stretches, far)
    used_s = max(n_steady, 1) * stretches[0].context.window_s
    entries = tuple(applied.to_mapping() for applied in habits)
    return Knowledge(noise, features, mean, root, wander, n_spikes / used_s, entries)


def _fitted(features: Features, stretches: Sequence[Stretch]) -> list[Array] | None:
    """Return what was fitted: the curve, freely, and all that is learnt, (N, K) a stretch.

    None for so many rows that it took next to nothing from them.
    """
    if sum(s.context.n for s in stretches) > _MANY_ROWS:
        return None
    free = np.array(features.groups) == "phase"
    deviations = np.where(free, features.top_rad_s, features.prior)
    return [np.column_stack(list(features.columns(s))) * deviations for s in stretches]


def _learn(
    features: Features,
    stretches: Sequence[Stretch],
    noise: Noise,
    masks: Sequence[Mask],
    own: Sequence[Array],
) -> tuple[Array, Array, Array, tuple[Array, Array]]:
    """Coefficients, root of how far a run may be from them, each run's own and their equations."""
    prior = features.prior
    n_runs, n_own = 1 + max(s.run for s in stretches), own[0].shape[1]
    size = prior.size + n_own * n_runs
    shown = np.zeros((n_own, size), dtype=np.bool_)
    parts = []
    for s, mask, departed in zip(stretches, masks, own, strict=True):
        shapes = np.zeros((s.context.n, size))
        shapes[:, : prior.size] = np.column_stack(list(features.columns(s))) * prior
        at = prior.size + n_own * s.run + np.arange(n_own)
        shapes[:, at] = departed
        shown[np.arange(n_own), at] |= np.any(departed != 0.0, axis=0)
        white = whitening(noise, s)[mask]
        shaped, error = (np.asarray(white @ part) for part in (shapes, s.residual_rad_s))
        parts.append((s, shaped, error, mask))
    # What all runs have in common belongs to the model's error, which the shapes carry.
    common = _TIED * shown
    ties = np.eye(size) + common.T @ common
    theta = np.zeros(size)
    whole = _moments(parts, [np.ones(error.size) for *_, error, _ in parts], size, n_runs)
    for _ in range(_ROUNDS):
        # Few rows are far out: cheaper to take these off again than to weigh all.
        far = _moments(parts, _far_shares(parts, theta), size, n_runs)
        grams, slopes = (all_rows - off for all_rows, off in zip(whole, far, strict=True))
        gram, slope = grams.sum(axis=0) + ties, slopes.sum(axis=0)
        theta = np.linalg.solve(gram, slope)
    covariance = np.linalg.inv(gram)
    extra = _between(features.groups, grams, slopes)
    root = np.linalg.cholesky(covariance[: prior.size, : prior.size] + np.diag(extra**2))
    runs = theta[prior.size :].reshape(n_runs, n_own)
    learnt = np.arange(size) < prior.size
    left, toward = beside(grams.sum(axis=0) + np.diag(learnt.astype(float)), slope, ~learnt)
    equations = left.reshape(runs.shape * 2), toward.reshape(runs.shape)
    return prior * theta[: prior.size], prior[:, None] * root, runs, equations


def _far_shares(parts: Sequence[Part], theta: Array) -> list[Array]:
    """Share by which each row does not count (Huber)."""
    return [
        1.0 - np.minimum(1.0, _HUBER / np.maximum(np.abs(error - shapes @ theta), 1e-12))
        for _, shapes, error, _ in parts
    ]


def _moments(
    parts: Sequence[Part], shares: Sequence[Array], size: int, n_runs: int
) -> tuple[Array, Array]:
    """Return the weighed normal equations of each fold: a run each, or parts of a single one."""
    n_folds = n_runs if n_runs > 1 else _FOLDS
    grams, slopes = np.zeros((n_folds, size, size)), np.zeros((n_folds, size))
    for (s, shapes, error, mask), share in zip(parts, shares, strict=True):
        fold = np.full(mask.size, s.run)
        if n_runs == 1:
            fold = np.arange(mask.size) // _BLOCK % _FOLDS
        for k in np.unique(fold):
            rows = (fold[mask] == k) & (share > 0.0)
            weighed = shapes[rows] * share[rows, None]
            grams[k] += weighed.T @ shapes[rows]
            slopes[k] += weighed.T @ error[rows]
    return grams, slopes


def _between(groups: Sequence[str], grams: Array, slopes: Array) -> Array:
    """Deviation of a fold's coefficients beyond their error, in priors, by group.

    With b₋ from the other folds and its covariance C, the score u = Xᵀ(y − X b₋) of the fold left
    out has the covariance G + G C G + τ² G_g G_gᵀ for the group's columns; the trace gives τ².
    """
    names = np.array(groups)
    total, slope = grams.sum(axis=0) + np.eye(grams.shape[1]), slopes.sum(axis=0)
    extra = np.zeros(names.size)
    above = {g: [0.0, 0.0, 0.0] for g in dict.fromkeys(groups)}
    for gram, own in zip(grams, slopes, strict=True):
        covariance = np.linalg.inv(total - gram)
        score = own - gram @ (covariance @ (slope - own))
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
