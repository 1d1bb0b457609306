"""Steps from or to a speed that a model only guesses: how a motor follows these is a guess, too."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch, stepped
from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.gaps import KINK
from usmbench.diagnose.noise.noise_model import LAGS

Array = NDArray[np.float64]

_LARGE = 0.1  # of the highest speed: steps that tell by which share they are followed otherwise


def following_guesses(
    stretches: Sequence[Stretch], features: Features, mean: Array
) -> list[Stretch]:
    """Let rows scatter after steps that lead from or to a guessed speed.

    A motor that brakes faster than it runs up follows a step otherwise than the simulation by a
    share of the step, which is known. Where the step may be another, so may that be, which shapes
    of the curve's error behind the simulation's own lag do not hold.

    Parameters
    ----------
    stretches
        The runs.
    features
        What the model may leave.
    mean
        How much of each shape it leaves, shape (K,).

    Returns
    -------
    list of Stretch
        The same runs.
    """
    if not (np.any(features.between_rad_s) and np.any(features.unmeasured_rad_s)):
        return list(stretches)
    after = np.array([g == "braking" or g.startswith("lag ") for g in features.groups])
    otherwise = [features.combined(s, np.where(after, mean, 0.0)) for s in stretches]
    shares = _shares(stretches, otherwise, _LARGE * features.top_rad_s)
    scatter = [shares[s.lag] * _guessed_rad_s(s, features) for s in stretches]
    return [
        replace(s, scatter_rad_s=np.hypot(s.scatter_rad_s, more_rad_s))
        for s, more_rad_s in zip(stretches, scatter, strict=True)
    ]


def _shares(stretches: Sequence[Stretch], otherwise: Sequence[Array], least_rad_s: float) -> Array:
    """By which share of a step it is followed otherwise, so many windows later, (longest + 1,)."""
    step = np.concatenate([s.step_rad_s for s in stretches])
    lag, off = np.concatenate([s.lag for s in stretches]), np.concatenate(list(otherwise))
    shares = np.zeros(1 + int(np.max(lag)))
    for k in range(min(LAGS, shares.size)):
        rows = (lag == k) & (np.abs(step) > least_rad_s)
        if rows.any():
            shares[k] = np.linalg.norm(off[rows]) / np.linalg.norm(step[rows])
    return shares


def _guessed_rad_s(stretch: Stretch, features: Features) -> Array:
    """By how much the step before each row may be another, shape (N,)."""
    phase_deg, begin = stretch.context.phase_deg, np.arange(stretch.context.n) - stretch.lag
    off = np.interp(phase_deg, features.nodes_deg, features.unmeasured_rad_s)
    either = np.hypot(off[begin], off[np.maximum(begin - 1, 0)])
    # Two phases close together are off alike.
    steepest = np.max(np.array(features.between_rad_s) / (KINK * np.diff(features.nodes_deg)))
    return np.asarray(np.minimum(either, steepest * np.abs(stepped(phase_deg, begin))))
