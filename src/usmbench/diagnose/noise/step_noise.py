"""What steps and the edges of the dead zone add to the noise, estimated from residuals."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.noise.noise_model import LAGS, STARTS, Noise
from usmbench.diagnose.noise.rotor_states import (
    KINDS,
    farther_out,
    runs_out,
    stands_below_rad_s,
    step_kind,
)
from usmbench.identify.robust_fit import OVER_MEDIAN

Array = NDArray[np.float64]

_SIZES, _FEWEST_OF_SIZE = 4, 8
_TRIMMED = 1.2  # what is left out above 97 % of a normal variable, and a little for heavier tails
_FEWEST_STARTS, _FEWEST_PAIRS = 20, 100  # rows
_MOSTLY = 0.5  # of the speed up to which a rotor counts as standing; nothing measured sets it
FAR = 4.0
"""Times the noise: what is farther out counts as that far."""


def noise_with_steps(
    phase_deg: Array,
    sigma_rad_s: Array,
    stretches: Sequence[Stretch],
    residuals: Sequence[Array],
    masks: Sequence[Mask],
) -> Noise:
    """Return a white noise with what steps and edges add to it.

    Parameters
    ----------
    phase_deg, sigma_rad_s
        Its standard deviation far from them, at rising phases, shape (K,) each.
    stretches
        The stretches.
    residuals
        What is left on each, in rad/s, shape (N,).
    masks
        Rows of each that count, shape (N,).
    """
    none, starts = np.zeros((LAGS, KINDS, _SIZES)), np.zeros(len(STARTS))
    noise = Noise(phase_deg, sigma_rad_s, np.empty(0), 1.0, none, none, starts, np.zeros(LAGS))
    runs = (stretches, residuals, masks)
    noise = replace(noise, running_out=_running_out(*runs, noise))
    sizes, spreads = _after_steps(*runs, noise)
    noise = replace(noise, step_rad_s=sizes, step_spread_rad_s=spreads)
    noise = replace(noise, start_rad_s=_at_edge(*runs, noise))
    return replace(noise, same_again=_returning(*runs, noise))


def _running_out(
    stretches: Sequence[Stretch], residuals: Sequence[Array], masks: Sequence[Mask], flat: Noise
) -> float:
    """Share of a turning rotor's noise in one that runs out, past the window of the stop itself.

    All of it where too few rows tell: runs that glide into the dead zone say nothing of steps.
    """
    shares = []
    for s, error, mask in zip(stretches, residuals, masks, strict=True):
        still = (s.lag > 0) | (np.abs(s.step_rad_s) < stands_below_rad_s(s))
        rows = mask & still & (runs_out(s) > _MOSTLY)
        shares.append(np.abs(error[rows]) / flat.last_driven_rad_s(s)[rows])
    share = np.concatenate(shares)
    return min(OVER_MEDIAN * float(np.median(share)), 1.0) if share.size >= _FEWEST_STARTS else 1.0


def _after_steps(
    stretches: Sequence[Stretch], residuals: Sequence[Array], masks: Sequence[Mask], flat: Noise
) -> tuple[Array, Array]:
    """Sizes of steps, and the residual's spread by these at each lag after each kind of step."""
    lag, size, kind, use, error, calm = (
        np.concatenate(columns)
        for columns in (
            [s.lag for s in stretches],
            [np.abs(s.step_rad_s) for s in stretches],
            [step_kind(s) for s in stretches],
            masks,
            residuals,
            [flat.calm_rad_s(s) for s in stretches],
        )
    )
    sizes, spreads = np.ones((LAGS, KINDS, _SIZES)), np.zeros((LAGS, KINDS, _SIZES))
    use &= size > 2.0 * float(np.median(flat.sigma_rad_s))
    for k, c in np.ndindex(LAGS, KINDS):
        rows = use & (lag == k) & (kind == c)
        sizes[k, c], spreads[k, c] = _by_size(size[rows], error[rows], calm[rows])
    return sizes, spreads


def _by_size(size_rad_s: Array, error: Array, calm: Array) -> tuple[Array, Array]:
    """Sizes of steps, and the residual's spread there beyond that far from steps."""
    n_bins = min(size_rad_s.size // _FEWEST_OF_SIZE, _SIZES)
    if n_bins == 0:
        return np.zeros(_SIZES), np.zeros(_SIZES)
    sizes, spreads = [], []
    for rows in np.array_split(np.argsort(size_rad_s, kind="stable"), n_bins):
        square = error[rows] ** 2
        kept = float(np.mean(square[square <= np.quantile(square, 0.97)]))
        sizes.append(float(np.mean(size_rad_s[rows])))
        beyond = _TRIMMED * kept - float(np.mean(calm[rows] ** 2))
        spreads.append(np.sqrt(max(beyond, 0.0)))
    missing = _SIZES - n_bins
    rising = np.maximum.accumulate(sizes)  # means of equal sizes differ in their last digit
    return np.pad(rising, (missing, 0), mode="edge"), np.pad(spreads, (missing, 0), mode="edge")


def _at_edge(
    stretches: Sequence[Stretch], residuals: Sequence[Array], masks: Sequence[Mask], flat: Noise
) -> Array:
    """Residual's spread where the dead zone ends, beyond the noise's elsewhere."""
    rows = [mask & (s.lag > 0) for s, mask in zip(stretches, masks, strict=True)]
    share = np.concatenate([farther_out(s)[r] for s, r in zip(stretches, rows, strict=True)])
    square = np.concatenate([e[r] ** 2 for e, r in zip(residuals, rows, strict=True)])
    usual = np.concatenate(
        [flat.level_rad_s(s)[r] ** 2 for s, r in zip(stretches, rows, strict=True)]
    )
    nodes = np.array(STARTS)
    ends = np.r_[0.0, 0.5 * (nodes[1:] + nodes[:-1]), 1.5 * nodes[-1]]
    spreads = np.zeros(nodes.size)
    for k, (low, high) in enumerate(pairwise(ends)):
        near = (share > low) & (share <= high)
        if np.count_nonzero(near) >= _FEWEST_STARTS:
            kept = square[near] <= np.quantile(square[near], 0.98)
            beyond = float(np.mean(square[near][kept])) - float(np.mean(usual[near][kept]))
            spreads[k] = np.sqrt(max(beyond, 0.0))
    return spreads


def _returning(
    stretches: Sequence[Stretch], residuals: Sequence[Array], masks: Sequence[Mask], flat: Noise
) -> Array:
    """Correlation of the residual's parts after the same jump, by lag; 1 where none repeats."""
    found = np.ones(LAGS)
    for k in range(LAGS):
        pairs, alike, even = 0, 0.0, 0.0
        for s, error, mask in zip(stretches, residuals, masks, strict=True):
            rows = np.flatnonzero(mask & (s.lag == k) & (s.again > 1) & (s.step_rad_s != 0.0))
            same = s.jump[rows]
            unit = np.clip((error / flat.level_rad_s(s))[rows], -FAR, FAR)
            count, total, square = (
                np.bincount(same, w) for w in (np.ones(rows.size), unit, unit**2)
            )
            pairs += int(np.sum(count * (count - 1.0)))
            alike += float(np.sum(total**2 - square))
            even += float(np.sum((count - 1.0) * square))
        if pairs >= _FEWEST_PAIRS:
            found[k] = np.clip(alike / max(even, 1e-12), 0.0, 1.0)
    return found
