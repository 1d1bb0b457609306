"""The noise of a free-running residual estimated, with medians and trimmed means."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.dead_zone import edge_of_standstill_deg
from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.noise.colour import taken_by_fit
from usmbench.diagnose.noise.levels import levels
from usmbench.diagnose.noise.noise_model import LAGS, Noise
from usmbench.diagnose.noise.rotor_states import runs_out, turns, whole_count_rad_s
from usmbench.diagnose.noise.step_noise import FAR, noise_with_steps
from usmbench.identify.noise import autoregression

Array = NDArray[np.float64]

_HIGHEST_ORDER = 6
_AT_REST = 1e-3  # of the highest speed: of a rotor that creeps, single counts are seen
_FEWEST_QUIET = 50  # rows
_RUNS_OUT = 0.1  # of the speed up to which a rotor counts as standing; nothing measured sets it
_QUARTERS = 4  # of the phases: the fewest that tell near and far from the dead zone on both sides
_QUIET_SHARE, _NO_STEP_RAD_S = 0.2, 1e-9  # of the rows of a rotor that turns
_WAVES = 0.1  # of what is left in the middle row; nothing measured sets it
_LEAST = 1e-5  # of the highest speed; speeds that were computed have no noise, nor its colour
_CALM, _FEWEST_CALM = 0.9, 500  # of the level; rows
_AS_STATED = 1.2  # times: what a model states is rounded, and an estimate off by a tenth


def estimate_noise(
    stretches: Sequence[Stretch],
    residuals: Sequence[Array],
    masks: Sequence[Mask],
    fitted: Sequence[Array] | None = None,
) -> Noise:
    """Estimate the noise from residuals, with medians that spikes do not move.

    Parameters
    ----------
    stretches
        The stretches.
    residuals
        What is left on each, in rad/s.
    masks
        Rows that count.
    fitted
        Columns that were fitted to these very rows, in their standard deviations in rad/s, shape
        (N, K) a stretch; None where the residuals are those of other runs than the fit.
    """
    phase_deg = np.concatenate([s.context.phase_deg for s in stretches])
    error = np.concatenate(list(residuals))
    quiet = _quiet(stretches, error, np.concatenate(list(masks)))
    centres, sigma = levels(phase_deg[quiet], error[quiet], _dead_zone_deg(stretches))
    least_rad_s = _LEAST * max(float(np.max(np.abs(s.settled_rad_s))) for s in stretches)
    flat = noise_with_steps(centres, np.maximum(sigma, least_rad_s), stretches, residuals, masks)
    if np.all(sigma < least_rad_s):
        return flat
    ar, innovation = _colour(stretches, residuals, masks, flat, fitted)
    return replace(flat, ar=ar, innovation=innovation)


def _quiet(stretches: Sequence[Stretch], error: Array, use: Mask) -> Mask:
    """Rows that show the noise alone, of a rotor that turns, too: far from steps, or after little.

    Where a phase glides, the few rows at its crest, those of a rotor at rest, and those of a
    warm-up at one phase say too little. A rotor that runs out in the dead zone has not the noise of
    one that stands there. One that stood and stands took no step, though its curve waves a little.
    """
    lag = np.concatenate([s.lag for s in stretches])
    size = np.concatenate([np.abs(s.step_rad_s) for s in stretches])
    use = use & ~np.concatenate([runs_out(s) > _RUNS_OUT for s in stretches])
    turning = use & np.concatenate([turns(s) for s in stretches])
    n_turning = max(int(np.count_nonzero(turning)), 1)
    waves_rad_s = _WAVES * float(np.median(np.abs(error[use]))) if use.any() else 0.0
    still = ~turning & (size < waves_rad_s)
    far: Mask = use & ((lag >= LAGS) | (size < _NO_STEP_RAD_S) | still)
    if _at_all_phases(stretches, far & turning, turning):
        return far
    near = use & (lag >= min(2, int(lag[use].max(initial=0))))
    if np.count_nonzero(near & turning) >= max(_FEWEST_QUIET, _QUIET_SHARE * n_turning):
        return near
    share = min(max(_QUIET_SHARE, _FEWEST_QUIET / n_turning), 1.0)
    small = turning & (size <= np.quantile(size[turning], share)) if turning.any() else use
    return np.asarray(far | near | small)


def _at_all_phases(stretches: Sequence[Stretch], rows: Mask, turning: Mask) -> bool:
    """Whether there are rows enough in each quarter of those of a rotor that turns, by phase."""
    phase_deg = np.concatenate([s.context.phase_deg for s in stretches])
    quarters = np.array_split(np.flatnonzero(turning)[np.argsort(phase_deg[turning])], _QUARTERS)
    fewest = min(int(np.count_nonzero(rows[quarter])) for quarter in quarters)
    return _QUARTERS * fewest >= _FEWEST_QUIET


def _dead_zone_deg(stretches: Sequence[Stretch]) -> tuple[float, float]:
    """Lowest and highest phase at which the rotor stands at every operating point."""
    phase_deg = np.concatenate([s.context.phase_deg for s in stretches])
    size_deg = np.concatenate([edge_of_standstill_deg(s, _AT_REST) for s in stretches])
    low, high = (
        float(np.min(size_deg[way * phase_deg > 0.0], initial=180.0)) for way in (-1.0, 1.0)
    )
    return -low, high


def _colour(
    stretches: Sequence[Stretch],
    residuals: Sequence[Array],
    masks: Sequence[Mask],
    flat: Noise,
    fitted: Sequence[Array] | None,
) -> tuple[Array, float]:
    """Autoregression of the standardised residual, on rows that tell its colour and its size.

    Jitter has no colour, and a rotor that stands may have no noise, which would make that of one
    that turns seem less.
    """
    levels = [flat.level_rad_s(stretch) for stretch in stretches]
    calm = [flat.calm_rad_s(s) > _CALM * level for s, level in zip(stretches, levels, strict=True)]
    turning = [turns(s) for s in stretches]
    for telling in (turning, calm):
        fewer = [mask & rows for mask, rows in zip(masks, telling, strict=True)]
        if sum(int(np.count_nonzero(rows)) for rows in fewer) >= _FEWEST_CALM:
            masks = fewer
    moments = np.zeros(_HIGHEST_ORDER + 1)
    counts = np.zeros(_HIGHEST_ORDER + 1)
    for level, residual, mask in zip(levels, residuals, masks, strict=True):
        unit = residual / level
        unit = np.where(mask, np.clip(unit, -FAR, FAR), 0.0)
        for k in range(_HIGHEST_ORDER + 1):
            pairs = mask[k:] & mask[: mask.size - k]
            moments[k] += float(unit[k:] @ unit[: unit.size - k])
            counts[k] += np.count_nonzero(pairs)
    left = moments / np.maximum(counts, 1.0)
    if fitted is None:
        return autoregression(left, counts[0])
    rows = [f[m] / v[m, None] for f, v, m in zip(fitted, levels, masks, strict=True)]
    return autoregression(left + taken_by_fit(rows, left, counts[0]), counts[0])


def noise_as_stated(
    stretches: Sequence[Stretch],
    residuals: Sequence[Array],
    masks: Sequence[Mask],
    stated_rad_s: float,
) -> Noise:
    """Estimate a noise, no larger than a model states and counting adds.

    Of a run alone nobody knows what is noise: a hum that the model does not have looks like it. A
    window's counts are the difference of two angles, each off by anything within a count.

    Parameters
    ----------
    stretches, residuals, masks
        As in `estimate_noise`.
    stated_rad_s
        Standard deviation that the model states; 0 for none.
    """
    noise = estimate_noise(stretches, residuals, masks)
    if stated_rad_s <= 0.0:
        return noise
    counts = [s.context.count_rad_s or whole_count_rad_s(s) for s in stretches]
    counting_rad_s = max(counts, default=0.0) / np.sqrt(6.0)
    most_rad_s = _AS_STATED * float(np.hypot(stated_rad_s, counting_rad_s))
    calm = np.concatenate([noise.calm_rad_s(s)[s.use] for s in stretches])
    least = most_rad_s / max(float(np.sqrt(np.mean(calm**2))), 1e-12)
    return replace(noise, sigma_rad_s=min(least, 1.0) * noise.sigma_rad_s)
