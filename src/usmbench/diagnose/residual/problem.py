"""The whitened problem: how far a simulation is from the measurement, given all that is known."""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.known.knowledge import Knowledge
from usmbench.diagnose.noise.chance_scatter import chance_scatter_rad_s
from usmbench.diagnose.noise.noise_model import Noise
from usmbench.diagnose.residual.covariance import Covariance, whitened_by
from usmbench.diagnose.residual.form import ROUGHLY, edges_elsewhere, off_in_form
from usmbench.diagnose.residual.free_runs import FreeRuns
from usmbench.diagnose.residual.shown_motor import counters_of, expected_as_counted, shown_by
from usmbench.diagnose.residual.weighed_residual import WeighedResidual
from usmbench.model.applied import Applied
from usmbench.model.effects.base import PHYSICS
from usmbench.model.extended import at_shaft_angle

Array = NDArray[np.float64]

_ANY = 1e3  # typical sizes


class Problem(WeighedResidual):
    """Stretches, their noise and what is known, ready to weigh residuals.

    Parameters
    ----------
    stretches
        The runs.
    known
        What is known beforehand.
    noise
        The noise in force.
    masks
        Rows of each stretch that count.
    own
        The model's own effects.
    """

    def __init__(
        self,
        stretches: Sequence[Stretch],
        known: Knowledge,
        noise: Noise,
        masks: Sequence[Mask],
        own: Sequence[Applied] = (),
    ):
        self.known = known
        self.own = tuple(own)
        self._runs = FreeRuns(stretches)
        self._expected_rad_s = [known.expected_rad_s(s) for s in stretches]
        left = [s.residual_rad_s - e for s, e in zip(stretches, self._expected_rad_s, strict=True)]
        covariance = Covariance.of(whitened_by(noise, stretches, None), known, stretches)
        super().__init__(stretches, left, noise, covariance, masks)

    def weighed(
        self, noise: Noise, masks: Sequence[Mask], weights: Sequence[Array] | None = None
    ) -> "Problem":
        """Return the same runs by another noise.

        Parameters
        ----------
        noise
            The noise.
        masks
            Rows of each stretch that count.
        weights
            Factor on each whitened row of each stretch; None for 1.
        """
        other = copy(self)
        other.noise = noise
        factors = None if weights is None else np.concatenate(weights)
        other._covariance = self._covariance.by(whitened_by(noise, self.stretches, factors))
        other._judge(masks)
        return other

    def with_masks(self, masks: Sequence[Mask]) -> "Problem":
        """Return the same problem on other rows.

        Parameters
        ----------
        masks
            Rows of each stretch that count.
        """
        other = copy(self)
        other._judge(masks)
        return other

    def doubting(self, effects: Sequence[Applied], form_off: float = PHYSICS) -> "Problem":
        """Return the same problem where the form of effects may be off.

        Parameters
        ----------
        effects
            The effects.
        form_off
            By which share of themselves.
        """
        changes = self.change_rad_s(effects)
        off = [off_in_form(s, c, form_off) for s, c in zip(self.stretches, changes, strict=True)]
        share = self.known.wander.either_edge
        edges = [edges_elsewhere(s, self.own, effects, share) for s in self.stretches]
        columns = np.hstack([np.concatenate(off), np.concatenate(edges)])
        level = np.concatenate([self.noise.level_rad_s(s) for s in self.stretches])
        kept = 1.0 / np.hypot(1.0, ROUGHLY * np.concatenate(changes) / level)
        return self._where(self._covariance.also(columns, 1.0, kept))

    def freeing(self, effects: Sequence[Applied]) -> "Problem":
        """Return the same problem where effects may be there by any size.

        Parameters
        ----------
        effects
            The effects, of a typical size.
        """
        changes = np.concatenate(self.change_rad_s(effects))
        return self._where(self._covariance.also(changes[:, None], _ANY))

    def showing(self, effects: Sequence[Applied]) -> "Problem":
        """Return the same problem of a motor that shows effects.

        What changes the speed by a share, as another gain and a warm motor do, changes what effects
        make of it by as much. What the curve is known to be off by, on average over the phases near
        each other, belongs to the phases that are set, which a coarse grid does not shift.

        Parameters
        ----------
        effects
            The effects.
        """
        changes = self.change_rad_s(effects)
        shown = [shown_by(s, c, effects) for s, c in zip(self.stretches, changes, strict=True)]
        counters = counters_of(effects)
        if not counters:
            return self._leaving(shown)
        shaft = self.change_rad_s([a for a in effects if a not in counters])
        parts = zip(self.stretches, shaft, strict=True)
        expected = [expected_as_counted(self.known, s, c, counters) for s, c in parts]
        return self._leaving(shown, expected)

    def turned(self, effects: Sequence[Applied]) -> "Problem":
        """Return the same problem with the angle that the shaft has where effects lose counts.

        Parameters
        ----------
        effects
            The effects.
        """
        every = (*self.own, *effects)
        other = copy(self)
        other.stretches = tuple(
            replace(s, context=at_shaft_angle(every, s.simulated_rad_s, s.context))
            for s in self.stretches
        )
        other._runs = self._runs.turned(other.stretches)
        return other._leaving(other.stretches)

    def scattering(self, chancy: Sequence[Applied], effects: Sequence[Applied]) -> "Problem":
        """Return the same problem where rows that chance strikes scatter, and all of them count.

        Weights and masks keep what is far out from the fit: of what chance does, they would leave
        less than its mean.

        Parameters
        ----------
        chancy
            Causes that act by chance.
        effects
            All causes.
        """
        changes = self.change_rad_s(chancy)
        uses = [s.use for s in self.stretches]
        scatter = chance_scatter_rad_s(changes, self.left_rad_s(effects), uses)
        other = copy(self)
        other.stretches = tuple(
            replace(s, scatter_rad_s=np.hypot(s.scatter_rad_s, by_chance))
            for s, by_chance in zip(self.stretches, scatter, strict=True)
        )
        rows = zip(self.masks, uses, changes, strict=True)
        return other.weighed(self.noise, [m | (use & (c != 0.0)) for m, use, c in rows])

    def measuring(self, residual_rad_s: Sequence[Array]) -> "Problem":
        """Return the same problem of a motor that leaves another residual.

        Parameters
        ----------
        residual_rad_s
            Beyond what it is known to leave, by stretch, shape (N,) each.
        """
        other = copy(self)
        other.residual_rad_s = list(residual_rad_s)
        other._take_residual()
        return other

    def change_rad_s(self, effects: Sequence[Applied]) -> list[Array]:
        """Return what effects change in the free run, by stretch.

        Parameters
        ----------
        effects
            The effects, beyond the model's own.
        """
        extended = self._runs.speed_rad_s((*self.own, *effects))
        return [e - s.simulated_rad_s for e, s in zip(extended, self.stretches, strict=True)]

    def speeds_rad_s(self, many: Sequence[Sequence[Applied]]) -> Array:
        """Return the free runs of several motors at once, stretch after stretch, shape (N, M).

        Parameters
        ----------
        many
            The effects of each, beyond the model's own.
        """
        return self._runs.together_rad_s([(*self.own, *effects) for effects in many])

    def left_rad_s(self, effects: Sequence[Applied]) -> list[Array]:
        """Return the residual of each stretch with effects taken out, in rad/s, shape (N,).

        Parameters
        ----------
        effects
            The effects, beyond the model's own; none leaves the residual as it is.
        """
        if not effects:
            return self.residual_rad_s
        changes = self.change_rad_s(effects)
        return [r - c for r, c in zip(self.residual_rad_s, changes, strict=True)]

    def left(self, effects: Sequence[Applied]) -> Array:
        """Return the carried residual with effects taken out, shape (M,).

        Parameters
        ----------
        effects
            The effects, beyond the model's own; none leaves the residual as it is.
        """
        return self.carried(self.left_rad_s(effects)) if effects else self.residual

    def drop(self, effects: Sequence[Applied]) -> float:
        """Return by how much effects lower the deviance.

        Parameters
        ----------
        effects
            The effects, beyond the model's own.
        """
        return self.deviance - self.square(self.left_rad_s(effects))

    def _leaving(
        self, stretches: Sequence[Stretch], expected_rad_s: list[Array] | None = None
    ) -> "Problem":
        """Return the same problem with what is no news as these runs show it."""
        other = self._where(Covariance.of(self._covariance.filter_, self.known, stretches))
        other._expected_rad_s = expected_rad_s or [self.known.expected_rad_s(s) for s in stretches]
        parts = zip(self.residual_rad_s, self._expected_rad_s, other._expected_rad_s, strict=True)
        return other.measuring([left + before - now for left, before, now in parts])

    def _where(self, covariance: Covariance) -> "Problem":
        """Return the same problem by another covariance."""
        other = copy(self)
        other._covariance = covariance
        other._judge(self.masks)
        return other
