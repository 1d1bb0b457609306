"""The noise of a free-running residual: its size by phase, its colour, and the steps' jitter.

The residual is taken as ``e_t = √(σ(φ)² + κ_kc(|s|)²) n_t``, k windows after a step of s in the
settled speed, with n an autoregressive process of unit variance and c the kind of the step: from
running to running the same way, into a stop, out of one, or through one, which is a reversal. κ is
the moment at which a command takes effect within a window, which no free run can know, and grows
with the step; and that at which a stopping rotor sticks or a standing one comes free, which hardly
does.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_toeplitz

from usmbench.diagnose.stretches import Mask, Stretch

Array = NDArray[np.float64]

LAGS, KINDS = 6, 4
_SIZES, _FEWEST_OF_SIZE = 4, 8
_HIGHEST_ORDER = 6
_BINS = 16
_CORNER_DEG = 1.0
_DISTRUST = 0.3
_STANDING = 0.02  # of the highest speed
_TRIMMED = 1.2  # what is left out above 97 % of a normal variable, and a little for heavier tails
_LEAST_SHARE = 0.3  # of the middle noise level: a standing rotor shows none, yet is not exact
_NORMAL = 1.4826  # standard deviation over median absolute deviation


@dataclass(frozen=True, slots=True)
class Noise:
    """The noise of a bench.

    Parameters
    ----------
    phase_deg, sigma_rad_s
        Standard deviation σ at some phases (rising), shape (K,).
    ar
        Coefficients of n_t = Σ ar_i n_{t−i} + innovation, shape (p,).
    innovation
        Standard deviation of the innovation.
    step_rad_s, step_spread_rad_s
        Sizes |s| of a step (rising) and κ at these, shape (LAGS, KINDS, sizes).
    """

    phase_deg: Array
    sigma_rad_s: Array
    ar: Array
    innovation: float
    step_rad_s: Array
    step_spread_rad_s: Array

    def level_rad_s(self, stretch: Stretch) -> Array:
        """Return the standard deviation on each row of a stretch.

        Parameters
        ----------
        stretch
            The stretch.
        """
        sigma = np.interp(stretch.context.phase_deg, self.phase_deg, self.sigma_rad_s)
        size, kind = np.abs(stretch.step_rad_s), step_kind(stretch)
        spread = np.zeros(size.size)
        for k, c in np.ndindex(LAGS, KINDS):
            rows = (stretch.lag == k) & (kind == c)
            nodes, values = (np.r_[0.0, a[k, c]] for a in (self.step_rad_s, self.step_spread_rad_s))
            beyond = np.maximum(size[rows] / max(nodes[-1], 1e-300), 1.0)
            spread[rows] = np.interp(size[rows], nodes, values) * beyond
        level: Array = np.hypot(np.hypot(sigma, spread), bend_rad_s(stretch))
        return level

    def to_mapping(self) -> dict[str, Any]:
        """Return what the model file keeps."""
        return {
            "phase_deg": self.phase_deg.tolist(),
            "sigma_rad_s": self.sigma_rad_s.tolist(),
            "ar": self.ar.tolist(),
            "innovation": self.innovation,
            "step_rad_s": self.step_rad_s.tolist(),
            "step_spread_rad_s": self.step_spread_rad_s.tolist(),
        }


def noise_from_mapping(content: dict[str, Any]) -> Noise:
    """Return the noise that a model file keeps.

    Parameters
    ----------
    content
        As `Noise.to_mapping` returns it.

    Raises
    ------
    KeyError
        A key is missing.
    """
    names = ("phase_deg", "sigma_rad_s", "ar", "step_rad_s", "step_spread_rad_s")
    arrays = {name: np.array(content[name], dtype=np.float64) for name in names}
    return Noise(innovation=float(content["innovation"]), **arrays)


def estimate_noise(
    stretches: Sequence[Stretch], residuals: Sequence[Array], masks: Sequence[Mask]
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
    """
    phase_deg = np.concatenate([s.context.phase_deg for s in stretches])
    lag = np.concatenate([s.lag for s in stretches])
    kind = np.concatenate([step_kind(s) for s in stretches])
    step = np.concatenate([s.step_rad_s for s in stretches])
    use = np.concatenate(list(masks))
    error = np.concatenate(list(residuals))
    quiet = use & ((lag >= LAGS) | (np.abs(step) < 1e-9))
    if np.count_nonzero(quiet) < 50:
        quiet = use & (lag >= min(2, int(lag[use].max(initial=0))))
    centres, sigma = _levels(phase_deg[quiet], error[quiet])
    middle = float(np.median(sigma))
    sizes, spreads = np.ones((LAGS, KINDS, _SIZES)), np.zeros((LAGS, KINDS, _SIZES))
    for k, c in np.ndindex(LAGS, KINDS):
        rows = use & (lag == k) & (kind == c) & (np.abs(step) > 2.0 * middle)
        sizes[k, c], spreads[k, c] = _by_size(np.abs(step[rows]), error[rows], middle)
    flat = Noise(centres, sigma, np.empty(0), 1.0, sizes, spreads)
    ar, innovation = _colour(stretches, residuals, masks, flat)
    return replace(flat, ar=ar, innovation=innovation)


def bend_rad_s(stretch: Stretch) -> Array:
    """Return how little the curve can be trusted where it bends sharply: where the motor starts.

    Parameters
    ----------
    stretch
        The stretch.
    """
    curve, phase_deg = stretch.context.settled_rad_s, stretch.context.phase_deg
    around = curve(phase_deg - _CORNER_DEG) + curve(phase_deg + _CORNER_DEG)
    bend: Array = _DISTRUST * np.abs(around - 2.0 * stretch.settled_rad_s)
    return bend


def step_kind(stretch: Stretch) -> NDArray[np.int64]:
    """Return the kind of each row's last step: 0 runs on, 1 into a stop, 2 out of it, 3 through it.

    Parameters
    ----------
    stretch
        The stretch.
    """
    after = stretch.settled_rad_s
    before = after - stretch.step_rad_s
    least = _STANDING * float(np.max(np.abs(after), initial=0.0))
    stopped, stood = np.abs(after) <= least, np.abs(before) <= least
    return np.select([stopped, stood, before * after < 0.0], [1, 2, 3], 0)


def _levels(phase_deg: Array, error: Array) -> tuple[Array, Array]:
    """Robust standard deviation in bins of equal numbers of rows along the phase."""
    n_bins = int(np.clip(phase_deg.size // 60, 1, _BINS))
    centres, sigma = [], []
    for rows in np.array_split(np.argsort(phase_deg, kind="stable"), n_bins):
        centres.append(float(np.mean(phase_deg[rows])))
        sigma.append(_spread(error[rows]))
    order = np.argsort(centres)
    levels = np.array(sigma)[order]
    middle = max(float(np.sqrt(np.mean(levels**2))), 1e-9)
    return np.array(centres)[order], np.maximum(levels, _LEAST_SHARE * middle)


def _spread(values: Array) -> float:
    """Robust standard deviation about 0: by the median, but not below the trimmed one."""
    size = np.abs(values)
    trimmed = values[size <= np.quantile(size, 0.98)]
    return max(_NORMAL * float(np.median(size)), float(np.sqrt(np.mean(trimmed**2))))


def _by_size(size_rad_s: Array, error: Array, sigma: float) -> tuple[Array, Array]:
    """Sizes of steps, and the residual's spread there beyond the noise's."""
    n_bins = min(size_rad_s.size // _FEWEST_OF_SIZE, _SIZES)
    if n_bins == 0:
        return np.ones(_SIZES), np.zeros(_SIZES)
    sizes, spreads = [], []
    for rows in np.array_split(np.argsort(size_rad_s, kind="stable"), n_bins):
        square = error[rows] ** 2
        kept = float(np.mean(square[square <= np.quantile(square, 0.97)]))
        sizes.append(float(np.mean(size_rad_s[rows])))
        spreads.append(np.sqrt(max(_TRIMMED * kept - sigma**2, 0.0)))
    missing = _SIZES - n_bins
    return np.pad(sizes, (missing, 0), mode="edge"), np.pad(spreads, (missing, 0), mode="edge")


def _colour(
    stretches: Sequence[Stretch], residuals: Sequence[Array], masks: Sequence[Mask], flat: Noise
) -> tuple[Array, float]:
    """Autoregression of the standardised residual, its order by BIC."""
    moments = np.zeros(_HIGHEST_ORDER + 1)
    counts = np.zeros(_HIGHEST_ORDER + 1)
    for stretch, residual, mask in zip(stretches, residuals, masks, strict=True):
        unit = residual / flat.level_rad_s(stretch)
        unit = np.where(mask, np.clip(unit, -4.0, 4.0), 0.0)
        for k in range(_HIGHEST_ORDER + 1):
            pairs = mask[k:] & mask[: mask.size - k]
            moments[k] += float(unit[k:] @ unit[: unit.size - k])
            counts[k] += np.count_nonzero(pairs)
    covariance = moments / np.maximum(counts, 1.0)
    best, chosen = np.inf, (np.empty(0), 1.0)
    for order in range(_HIGHEST_ORDER + 1):
        ar = solve_toeplitz(covariance[:order], covariance[1 : order + 1]) if order else np.empty(0)
        left = max(float(covariance[0] - ar @ covariance[1 : order + 1]), 1e-12)
        score = counts[0] * np.log(left) + order * np.log(max(counts[0], 2.0))
        if score < best:
            best, chosen = score, (np.asarray(ar, dtype=np.float64), float(np.sqrt(left)))
    return chosen
