"""The runs that a model was identified on, and what one round of learning takes from them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.known.departures import departures
from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.features_of_runs import features_of
from usmbench.diagnose.known.learning import Learnt, learn
from usmbench.diagnose.known.wander import Wander
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.noise.noise_model import Noise
from usmbench.diagnose.noise.spikes import PLAIN, count_steady, off_steps, spiked
from usmbench.model.applied import Applied

Array = NDArray[np.float64]

_MANY_ROWS = 3000


@dataclass(frozen=True, slots=True)
class HealthyRuns:
    """Healthy runs of one motor.

    Parameters
    ----------
    stretches
        The runs.
    features
        The family of shapes that a model of them may leave.
    shapes
        Its columns on each, shape (N, K).
    apart
        What each may be off by on its own, shape (N, O).
    fitted
        What has been fitted to each, with its deviations, shape (N, K); None where that took next
        to nothing of the noise.
    """

    stretches: Sequence[Stretch]
    features: Features
    shapes: Sequence[Array]
    apart: Sequence[Array]
    fitted: Sequence[Array] | None

    @classmethod
    def of(cls, stretches: Sequence[Stretch], habits: Sequence[Applied]) -> "HealthyRuns":
        """Return runs with what may be learnt from them.

        Parameters
        ----------
        stretches
            The runs.
        habits
            What they show anyhow, with which they were cut.
        """
        features = features_of(stretches)
        shapes = [np.column_stack(list(features.columns(s))) for s in stretches]
        apart = [departures(s, habits, features.n_constants) for s in stretches]
        # The curve was fitted freely, and all that is learnt: of many rows that took hardly any.
        few = sum(s.context.n for s in stretches) <= _MANY_ROWS
        of_curve = np.array(features.groups) == "phase"
        free = np.where(of_curve, features.top_rad_s, features.prior)
        fitted = [part * free for part in shapes] if few else None
        return cls(stretches, features, shapes, apart, fitted)

    @property
    def residuals(self) -> list[Array]:
        """Residual of each, in rad/s, shape (N,)."""
        return [s.residual_rad_s for s in self.stretches]

    @property
    def uses(self) -> list[Mask]:
        """Rows of each to look at, shape (N,)."""
        return [s.use for s in self.stretches]

    def noise(self, left: Sequence[Array], masks: Sequence[Mask]) -> Noise:
        """Return the noise.

        Parameters
        ----------
        left
            What is left of each, in rad/s, shape (N,).
        masks
            Rows of each that count, shape (N,).
        """
        return estimate_noise(self.stretches, left, masks, self.fitted)

    def near(self, left: Sequence[Array], noise: Noise) -> list[Mask]:
        """Return the rows of each that do not stand alone, shape (N,).

        Parameters
        ----------
        left
            What is left of each, in rad/s, shape (N,).
        noise
            The noise in force.
        """
        far = spiked(self.stretches, left, noise, near_steps=True)
        return [use & ~f for use, f in zip(self.uses, far, strict=True)]

    def learnt(
        self, noise: Noise, masks: Sequence[Mask], wander: Wander
    ) -> tuple[Learnt, list[Array]]:
        """Return what they teach, and what that leaves of each, in rad/s, shape (N,).

        Parameters
        ----------
        noise
            The noise in force.
        masks
            Rows of each that count, shape (N,).
        wander
            What each may be off by on its own.
        """
        own = [departed * wander.deviations for departed in self.apart]
        learnt = learn(self.features, self.stretches, self.shapes, noise, masks, own)
        left = [
            s.residual_rad_s - shapes @ learnt.mean - o @ learnt.runs[s.run]
            for s, shapes, o in zip(self.stretches, self.shapes, own, strict=True)
        ]
        return learnt, left

    def spikes_hz(self, left: Sequence[Array], noise: Noise) -> float:
        """Return the rate of steady windows that stand alone.

        Parameters
        ----------
        left
            What is left of each, in rad/s, shape (N,).
        noise
            The noise in force.
        """
        far = spiked(self.stretches, left, noise, near_steps=True, times=PLAIN)
        far = off_steps(self.stretches, left, far)
        n_spikes, n_steady = count_steady(self.stretches, far)
        return n_spikes / (max(n_steady, 1) * self.stretches[0].context.window_s)
