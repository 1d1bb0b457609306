"""What a search for causes came to, and what speaks for and against its names."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from usmbench.diagnose.cutting.stretches import Mask
from usmbench.diagnose.fitting.fit import NOTHING, Fit
from usmbench.diagnose.fitting.huber_weights import huber_weights
from usmbench.diagnose.fitting.intervals import AT_END, leans_on_an_end
from usmbench.diagnose.fitting.refining import refine
from usmbench.diagnose.naming.chance import chancy_of, leaves_scatter
from usmbench.diagnose.naming.ranking import TELLING, Ranked
from usmbench.diagnose.naming.remainder import LOUD, LOUD_ALONE
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.whole import PLAIN_P_VALUE, Whole, doubted_test

Array = NDArray[np.float64]

LEFT_PARTLY = 0.4  # of what was off: names that leave more explain too little of it
# Where no other reason stands beside a threshold here, it was chosen while watching draws of
# simulated motors (docs/explanations/diagnosis.md), and no measurement fixes it.
# What has no name is a finding only from half the noise's rms on, or from a seventh where chance
# shows as much in the views of one run in 10⁹; a name must earn its own place.
_LEAST_EXCESS, _LEAST_SURE, _SURE = 0.25, 0.02, 1e-9
_GROSS = 0.25  # of the noise's mean square, whose estimate may itself be off by a tenth
_TRIFLE = 0.01  # of what there was: what a form of an effect may be off by
_SCATTER = 0.5  # of what is left: the rest is smooth


@dataclass(frozen=True, slots=True)
class Found:
    """What the search came to.

    Parameters
    ----------
    problem
        The problem in its last state.
    spread
        Standard deviation of the whitened noise.
    ranked
        Every cause alone, best first.
    named
        One ranking a named cause, each given those before.
    fit
        All named causes together.
    before, after
        The tests over all views.
    if_cold
        Names that would stand if no run had begun with a warm motor.
    """

    problem: Problem
    spread: float
    ranked: list[Ranked]
    named: list[list[Ranked]]
    fit: Fit
    before: Whole
    after: Whole
    if_cold: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the causes, in the order of `named`."""
        return tuple(ranking[0].effect.name for ranking in self.named)

    @property
    def explained(self) -> float:
        """Drop of the deviance that the names bring, over the noise's spread."""
        return self.fit.statistic / self.spread**2

    @property
    def beyond_noise(self) -> float:
        """Deviance beyond the noise and all that is known, over the noise's spread."""
        return self.problem.deviance / self.spread**2 - self.problem.n_rows

    @property
    def plain(self) -> bool:
        """Whether views or rows show something, or these scatter widely, that nothing excuses.

        What moves an edge of the dead zone only some of the time is in few rows, and in no view.
        """
        rows = self._in_rows(self.beyond_noise)
        shown = any(w.beyond(PLAIN_P_VALUE, _LEAST_EXCESS) for w in (self.before, rows))
        return shown or self.before.beyond(_SURE, _LEAST_SURE) or self.spread > LOUD_ALONE

    @property
    def grid_leaves_more(self) -> bool:
        """Whether names fitted to where each phase falls leave more than chance does."""
        left = self._in_rows(self.beyond_noise - self.explained)
        return self.on_a_grid and min(left.p_value, self.after.p_value) < PLAIN_P_VALUE

    @property
    def off_in_all(self) -> float:
        """Deviance beyond the noise and what is no news that the names leave in all rows."""
        uses = [s.use for s in self.problem.stretches]
        return self._off(self.left_rad_s, uses, self.problem.unsure_rad_s(uses))

    @property
    def mostly_left(self) -> bool:
        """Whether most of what is beyond the noise and all that is known stays unexplained.

        A noise that has grown by so much that it is a finding itself is no noise here: then all
        that is off counts, also what another day might have done.
        """
        beyond, left = self.beyond_noise, self.beyond_noise - self.explained
        if self.spread > LOUD:
            residuals, masks = (self.problem.residual_rad_s, self.left_rad_s), self.problem.masks
            beyond, left = (self._off(r, masks, [0.0] * len(masks)) for r in residuals)
        return left > LEFT_PARTLY * max(beyond, 0.0) and left > _GROSS * self.problem.n_rows

    def _in_rows(self, excess: float) -> Whole:
        """Test what all rows show beyond the noise."""
        n_rows = self.problem.n_rows
        return Whole(excess, float(chi2.sf(excess + n_rows, n_rows)), n_rows)

    def _off(
        self,
        residual_rad_s: Sequence[Array],
        rows: Sequence[Mask],
        unsure_rad_s: Sequence[Array | float],
    ) -> float:
        """Squares beyond the noise, row by row."""
        off = 0.0
        parts = zip(self.problem.stretches, residual_rad_s, rows, unsure_rad_s, strict=True)
        for stretch, residual, use, unsure in parts:
            level = np.hypot(self.problem.noise.level_rad_s(stretch), unsure)
            off += float(np.sum(((residual / level) ** 2 - 1.0)[use]))
        return off

    @property
    def patched(self) -> bool:
        """Whether the names leave something smooth and plain that the library has no name for.

        Then they are more likely near the cause than the cause: a belt with a seam looks like a
        weight as long as the shaft turns to and fro within one turn of the belt.
        """
        trifle = _TRIFLE * max(self.before.excess, self.explained)
        scatter = _SCATTER * (self.beyond_noise - self.explained)
        return self.after.material and self.after.excess > max(trifle, scatter)

    @property
    def at_an_end(self) -> bool:
        """Whether a size or a shape is all that it may be: what would fit is something else.

        A share of all that there is has its end in itself, and so has what loses all.
        """
        sizes = (
            (end - p.null, a.values[p.name] - p.null)
            for a in self.fit.effects
            for p in a.effect.parameters
            for end in (p.low, p.high)
            if not p.scanned and not (p.unit == "1" and (end == -1.0 or (p.low, end) == (0.0, 1.0)))
        )
        if any(end != 0.0 and size / end > AT_END for end, size in sizes):
            return True
        return leans_on_an_end(self.problem, self.fit, TELLING * self.spread**2)

    @property
    def on_a_grid(self) -> bool:
        """Whether a name is fitted to where each phase falls: it says all, or by accident some."""
        return any(applied.effect.jagged for applied in self.fit.effects)

    @property
    def leaves_more(self) -> bool:
        """Whether the views show more of what is left than the names explain."""
        return self.after.p_value < PLAIN_P_VALUE and self.after.excess > self.explained

    def drop_names(self) -> "Found":
        """Return the same where no name stands: of a motor that does not show what was named."""
        if not self.named:
            return self
        problem = self.problem.showing(())
        return replace(self, problem=problem, named=[], fit=NOTHING, after=self.before)

    def count_scatter(self) -> "Found":
        """Return the same where the scatter that a cause by chance leaves counts as noise.

        The search keeps what is far out from its fits: of what chance does, these would leave less
        than its mean.
        """
        chancy = chancy_of(self.fit.effects)
        if not chancy or not leaves_scatter(self.problem, self.fit.effects):
            return self
        plain = self.problem.scattering(chancy, self.fit.effects)
        weights = huber_weights(plain, plain.left_rad_s(self.fit.effects))
        problem = plain.weighed(plain.noise, plain.masks, weights)
        fit = refine(problem, self.fit)
        after = doubted_test(problem, fit.effects, self.spread)
        return replace(self, problem=problem, fit=fit, after=after)

    @property
    def left_rad_s(self) -> list[Array]:
        """Residual of each stretch with the named causes taken out, in rad/s, shape (N,)."""
        return self.problem.left_rad_s(self.fit.effects)
