"""What is known of a model before a run is judged: its noise, its uncertainty, its known misfit.

`usmbench identify` measures it on the runs that the model was fitted on and the model file carries
it under ``residual: diagnosis``; for a model without it, cautious values stand in its place.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.noise import LAGS, Noise, estimate_noise, noise_from_mapping
from usmbench.diagnose.stretches import Stretch
from usmbench.errors import InputError
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import from_rest

Array = NDArray[np.float64]

KEY = "diagnosis"
_NODES = 25
_LEAST_GAIN = 1e-3  # repeatability that one run cannot show and no bench beats
_LEAST_DEAD_ZONE_DEG = 0.03
_LEAST_LAG = 0.01


@dataclass(frozen=True, slots=True)
class Knowledge:
    """What is known beforehand.

    Parameters
    ----------
    noise
        The noise; None where the model says nothing and the run itself must tell.
    nodes_deg
        Phases at which the known misfit is kept, rising, shape (K,).
    rising_rad_s, falling_rad_s
        Known mean residual there, after φ rose and after it fell, shape (K,).
    curve_rad_s
        Standard deviation of the curve's error at a node.
    lag
        Standard deviation of the mean residual after a step, as a share of the step, shape (LAGS,).
    gain
        Standard deviation of the gain from run to run, as a share.
    dead_zone_deg
        Standard deviation of the dead zone's half width from run to run.
    habits
        Effects that the identified runs showed already, as entries of a model's `effects`: of
        these only more than twice as much is news.
    spikes_hz
        Rate of windows that stand alone in the identified runs.
    """

    noise: Noise | None
    nodes_deg: Array
    rising_rad_s: Array
    falling_rad_s: Array
    curve_rad_s: float
    lag: Array
    gain: float
    dead_zone_deg: float
    habits: tuple[dict[str, Any], ...] = ()
    spikes_hz: float = 0.0

    def expected_rad_s(self, stretch: Stretch, noise: Noise) -> Array:
        """Return the mean residual of a stretch that is no news.

        Parameters
        ----------
        stretch
            The stretch.
        noise
            The noise in force.
        """
        phase_deg = stretch.context.phase_deg
        known = np.where(
            stretch.direction > 0.0,
            np.interp(phase_deg, self.nodes_deg, self.rising_rad_s),
            np.interp(phase_deg, self.nodes_deg, self.falling_rad_s),
        )
        total: Array = known + (0.0 if self.noise is None else noise.expected_rad_s(stretch))
        return total

    def to_mapping(self) -> dict[str, Any]:
        """Return what the model file keeps."""
        return {
            "noise": None if self.noise is None else self.noise.to_mapping(),
            "nodes_deg": self.nodes_deg.tolist(),
            "rising_rad_s": self.rising_rad_s.tolist(),
            "falling_rad_s": self.falling_rad_s.tolist(),
            "curve_rad_s": self.curve_rad_s,
            "lag": self.lag.tolist(),
            "gain": self.gain,
            "dead_zone_deg": self.dead_zone_deg,
            "habits": list(self.habits),
            "spikes_hz": self.spikes_hz,
        }


def knowledge_of(model: HammersteinModel) -> Knowledge:
    """Return what a model carries, or cautious values.

    Parameters
    ----------
    model
        The model.

    Raises
    ------
    InputError
        The model carries something else under this key.
    """
    content = model.residual.get(KEY)
    low_deg = min(p.phase_range_deg[0] for p in model.points)
    high_deg = max(p.phase_range_deg[1] for p in model.points)
    if content is None:
        nodes_deg = np.linspace(low_deg, high_deg, _NODES)
        zero = np.zeros(_NODES)
        noise_rad_s = float(np.median([p.noise_rad_s for p in model.points]))
        return Knowledge(
            None, nodes_deg, zero, zero, 0.2 * noise_rad_s, np.full(LAGS, 0.02), 1e-3, 0.05
        )
    try:
        return Knowledge(
            noise_from_mapping(content["noise"]),
            np.array(content["nodes_deg"], dtype=np.float64),
            np.array(content["rising_rad_s"], dtype=np.float64),
            np.array(content["falling_rad_s"], dtype=np.float64),
            float(content["curve_rad_s"]),
            np.array(content["lag"], dtype=np.float64),
            float(content["gain"]),
            float(content["dead_zone_deg"]),
            tuple(content["habits"]),
            float(content["spikes_hz"]),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"the model's residual: {KEY} is damaged ({error}); identify the model again"
        ) from error


def measure_knowledge(model: HammersteinModel, stretches: Sequence[Stretch]) -> Knowledge:
    """Measure noise, known misfit and repeatability on the runs that a model was identified on.

    Parameters
    ----------
    model
        The model.
    stretches
        Its runs.
    """
    residuals = [s.residual_rad_s for s in stretches]
    masks = [s.use for s in stretches]
    noise = estimate_noise(stretches, residuals, masks)
    bare = knowledge_of(replace(model, residual={}))
    rising, falling, curve_rad_s = _misfit(bare.nodes_deg, stretches, noise)
    gain, dead_zone_deg = _repeatability(stretches, noise)
    # When in its window a command acts may differ from plan to plan as it does within one.
    lag = np.maximum.reduce([np.full(LAGS, _LEAST_LAG), np.abs(noise.lag_mean), noise.lag_spread])
    return Knowledge(noise, bare.nodes_deg, rising, falling, curve_rad_s, lag, gain, dead_zone_deg)


def _misfit(
    nodes_deg: Array, stretches: Sequence[Stretch], noise: Noise
) -> tuple[Array, Array, float]:
    """Mean residual against phase after rises and falls, shrunk by its own error, and its size."""
    phase = np.concatenate([s.context.phase_deg for s in stretches])
    way = np.concatenate([s.direction for s in stretches])
    error = np.concatenate([s.residual_rad_s - noise.expected_rad_s(s) for s in stretches])
    level = np.concatenate([noise.level_rad_s(s) for s in stretches])
    use = np.concatenate([s.use for s in stretches])
    spread = noise.innovation / max(1.0 - float(noise.ar.sum()), 0.05)
    means, errors = np.zeros((2, nodes_deg.size)), np.ones((2, nodes_deg.size))
    nearest = np.abs(phase[:, None] - nodes_deg[None, :]).argmin(axis=1)
    for half, side in enumerate((1.0, -1.0)):
        for k in range(nodes_deg.size):
            rows = use & (nearest == k) & (way == side)
            if np.count_nonzero(rows) < 5:
                continue
            weight = 1.0 / level[rows] ** 2
            means[half, k] = float(np.sum(weight * error[rows]) / np.sum(weight))
            errors[half, k] = spread / np.sqrt(float(np.sum(weight)))
    seen = errors < 1.0
    if not np.any(seen):
        return means[0], means[1], float(np.median(level))
    excess = max(float(np.mean(means[seen] ** 2 - errors[seen] ** 2)), 0.0)
    shrink = np.where(seen, excess / (excess + errors**2), 0.0)
    own = float(np.median(errors[seen]))
    return shrink[0] * means[0], shrink[1] * means[1], float(np.hypot(np.sqrt(excess), own))


def _repeatability(stretches: Sequence[Stretch], noise: Noise) -> tuple[float, float]:
    """Wander of gain and dead zone from run to run, by one estimate of each a run."""
    runs = sorted({s.run for s in stretches})
    found = []
    for run in runs:
        mine = [s for s in stretches if s.run == run]
        gain = np.concatenate([s.simulated_rad_s[s.use] for s in mine])
        edge = np.concatenate([widening(s)[s.use] for s in mine])
        weight = 1.0 / np.concatenate([noise.level_rad_s(s)[s.use] for s in mine])
        error = np.concatenate([s.residual_rad_s[s.use] for s in mine])
        columns = np.column_stack([gain, edge]) * weight[:, None]
        found.append(np.linalg.lstsq(columns, error * weight, rcond=None)[0])
    if len(runs) < 2:
        return _LEAST_GAIN, _LEAST_DEAD_ZONE_DEG
    # A standard deviation of few values is itself uncertain: err on the side of more wander.
    inflation = 1.0 + 1.0 / np.sqrt(2.0 * (len(runs) - 1))
    gain_std, edge_std = np.std(np.array(found), axis=0, ddof=1) * inflation
    return max(float(gain_std), _LEAST_GAIN), max(float(edge_std), _LEAST_DEAD_ZONE_DEG)


def widening(stretch: Stretch) -> Array:
    """Return the change of speed for each degree by which the dead zone widens on both sides.

    Parameters
    ----------
    stretch
        The stretch.
    """
    context = stretch.context
    way = np.sign(context.phase_deg)
    moved = context.settled_rad_s(context.phase_deg - way)
    linear = context.linear
    return from_rest(linear.b, linear.a, linear.dead_time_windows, moved - stretch.settled_rad_s)
