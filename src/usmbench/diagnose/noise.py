"""The noise of a free-running residual: its size by speed, its colour, and the steps' jitter.

The residual is taken as ``e_t = m_k s + √(σ(v)² + (κ_k s)²) n_t``, k windows after a step of s in
the settled speed v, with n an autoregressive process of unit variance. The part in s is the moment
at which a command takes effect within a window, which no free run can know.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_toeplitz

from usmbench.diagnose.stretches import Mask, Stretch

Array = NDArray[np.float64]

LAGS = 6
_HIGHEST_ORDER = 6
_BINS = 8
_LEAST_SHARE = 0.3  # of the middle noise level: a standing rotor shows none, yet is not exact
_NORMAL = 1.4826  # standard deviation over median absolute deviation


@dataclass(frozen=True, slots=True)
class Noise:
    """The noise of a bench.

    Parameters
    ----------
    speed_rad_s, sigma_rad_s
        Standard deviation σ at some settled speeds (rising), shape (K,).
    ar
        Coefficients of n_t = Σ ar_i n_{t−i} + innovation, shape (p,).
    innovation
        Standard deviation of the innovation.
    lag_mean, lag_spread
        m_k and κ_k, as shares of the step, shape (LAGS,).
    """

    speed_rad_s: Array
    sigma_rad_s: Array
    ar: Array
    innovation: float
    lag_mean: Array
    lag_spread: Array

    def level_rad_s(self, stretch: Stretch) -> Array:
        """Return the standard deviation on each row of a stretch.

        Parameters
        ----------
        stretch
            The stretch.
        """
        sigma = np.interp(stretch.settled_rad_s, self.speed_rad_s, self.sigma_rad_s)
        spread = np.where(
            stretch.lag < LAGS, self.lag_spread[np.minimum(stretch.lag, LAGS - 1)], 0.0
        )
        level: Array = np.hypot(sigma, spread * stretch.step_rad_s)
        return level

    def expected_rad_s(self, stretch: Stretch) -> Array:
        """Return the mean residual that the steps are known to leave.

        Parameters
        ----------
        stretch
            The stretch.
        """
        mean = np.where(stretch.lag < LAGS, self.lag_mean[np.minimum(stretch.lag, LAGS - 1)], 0.0)
        return mean * stretch.step_rad_s

    def to_mapping(self) -> dict[str, Any]:
        """Return what the model file keeps."""
        return {
            "speed_rad_s": self.speed_rad_s.tolist(),
            "sigma_rad_s": self.sigma_rad_s.tolist(),
            "ar": self.ar.tolist(),
            "innovation": self.innovation,
            "lag_mean": self.lag_mean.tolist(),
            "lag_spread": self.lag_spread.tolist(),
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
    names = ("speed_rad_s", "sigma_rad_s", "ar", "lag_mean", "lag_spread")
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
    settled = np.concatenate([s.settled_rad_s for s in stretches])
    lag = np.concatenate([s.lag for s in stretches])
    step = np.concatenate([s.step_rad_s for s in stretches])
    use = np.concatenate(list(masks))
    error = np.concatenate(list(residuals))
    quiet = use & ((lag >= LAGS) | (np.abs(step) < 1e-9))
    if np.count_nonzero(quiet) < 50:
        quiet = use & (lag >= min(2, int(lag[use].max(initial=0))))
    centres, sigma = _levels(settled[quiet], error[quiet])
    mean, spread = _step_shares(lag, step, error, use, float(np.median(sigma)))
    flat = Noise(centres, sigma, np.empty(0), 1.0, mean, spread)
    ar, innovation = _colour(stretches, residuals, masks, flat)
    return Noise(centres, sigma, ar, innovation, mean, spread)


def _levels(settled: Array, error: Array) -> tuple[Array, Array]:
    """Robust standard deviation in bins of equal numbers of rows along the settled speed."""
    n_bins = int(np.clip(settled.size // 60, 1, _BINS))
    centres, sigma = [], []
    for rows in np.array_split(np.argsort(settled, kind="stable"), n_bins):
        centres.append(float(np.mean(settled[rows])))
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


def _step_shares(
    lag: NDArray[np.int64], step: Array, error: Array, use: Mask, sigma: float
) -> tuple[Array, Array]:
    """Mean and spread of the residual over the step, at each lag."""
    mean, spread = np.zeros(LAGS), np.zeros(LAGS)
    for k in range(LAGS):
        rows = use & (lag == k) & (np.abs(step) > 2.0 * sigma)
        if np.count_nonzero(rows) < 8:
            continue
        share = error[rows] / step[rows]
        weight = np.abs(step[rows])
        centre = float(np.average(np.clip(share, *np.quantile(share, [0.1, 0.9])), weights=weight))
        apart = (share - centre) ** 2
        noise = (sigma / step[rows]) ** 2
        kept = apart <= np.quantile(apart, 0.95)
        extra = float(np.average((apart - noise)[kept], weights=weight[kept])) * 1.2
        mean[k], spread[k] = centre, np.sqrt(max(extra, 0.0))
    return mean, spread


def _colour(
    stretches: Sequence[Stretch], residuals: Sequence[Array], masks: Sequence[Mask], flat: Noise
) -> tuple[Array, float]:
    """Autoregression of the standardised residual, its order by BIC."""
    moments = np.zeros(_HIGHEST_ORDER + 1)
    counts = np.zeros(_HIGHEST_ORDER + 1)
    for stretch, residual, mask in zip(stretches, residuals, masks, strict=True):
        unit = (residual - flat.expected_rad_s(stretch)) / flat.level_rad_s(stretch)
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
