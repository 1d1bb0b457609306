"""A model that was identified under the very cause it should show: identify it anew.

A counter that loses the sign leaves speeds from which a curve and dynamics can be identified, of
another motor. No extension of that model shows the cause. Where a cause says that it may lie
beneath runs and model alike, curve and dynamics are fitted again with it in place, and it is named
if that predicts blocks of the runs that neither fit has seen better than chance allows.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t, ttest_1samp

from usmbench.diagnose.anew.anew_fits import (
    CrossValidated,
    cross_validate,
    fits_beneath,
    plain_fits,
)
from usmbench.diagnose.anew.through_counter import Estimated
from usmbench.diagnose.cutting.stretches import Stretch, first_windows
from usmbench.diagnose.evidence import Estimate, NamedCause
from usmbench.diagnose.fitting.blocks import BLOCKS, FOLDS, block_of
from usmbench.diagnose.fitting.gain import Gain, gain_of_blocks
from usmbench.diagnose.naming.ranking import SIGNIFICANT
from usmbench.diagnose.naming.remainder import describe
from usmbench.diagnose.result import Diagnosis, Trace
from usmbench.identify.knots import dead_zone_deg
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Effect
from usmbench.model.hammerstein import HammersteinModel

Array = NDArray[np.float64]

_MOST_ROWS = 4000
_SIMPLER = 1.1  # a fit must beat the simpler ones before it by this factor of the mean square


@dataclass(frozen=True, slots=True)
class Anew:
    """What identifying anew came to.

    Parameters
    ----------
    stretches
        What was fitted, with the free run of the model as given.
    model
        The new model, with the cause among its effects.
    applied
        The cause.
    judged
        The new fit, and its like to parts of the rows.
    p_value
        Probability of predicting as much better where the cause is not there.
    """

    stretches: tuple[Stretch, ...]
    model: HammersteinModel
    applied: Applied
    judged: CrossValidated
    p_value: float

    def told(self, rest: Diagnosis) -> Diagnosis:
        """Return the diagnosis of the model as given, from that of the new one.

        Parameters
        ----------
        rest
            The diagnosis of the new model on the same runs.
        """
        gain = self.gain(rest.noise_floor_rad_s)
        effect = self.applied.effect
        cause = NamedCause(
            effect.name,
            effect.form,
            effect.meaning,
            effect.mend,
            (),
            tuple(self._estimates()),
            self.p_value,
            gain.gain,
        )
        all_said = rest.verdict == "no_discrepancy"
        return replace(
            rest,
            verdict="explained" if all_said else "partly_explained",
            causes=(cause,),
            remainder=None if all_said else rest.remainder or describe(rest.views, 1.0),
            extended=self.model,
            rmse_simulation_rad_s=gain.rmse_simulation_rad_s,
            rmse_extended_rad_s=gain.rmse_extended_rad_s,
            gain=gain.gain,
            gain_low=gain.low,
            gain_high=gain.high,
            traces=tuple(map(self._trace, rest.traces)),
            warnings=(
                *rest.warnings,
                f"the model was identified under {effect.name}; the extended model's curve and "
                "dynamics were identified anew with it in place",
            ),
        )

    def gain(self, noise_rad_s: float) -> Gain:
        """Score the new model on rows that its fits have not seen.

        Parameters
        ----------
        noise_rad_s
            Root mean square of the noise.
        """
        table = np.zeros((4, BLOCKS))
        for s, after in zip(self.stretches, self.judged.unseen_rad_s, strict=True):
            squares = (s.residual_rad_s**2, after**2, np.full(after.size, noise_rad_s**2))
            table += _sums(s, (*squares, np.ones(after.size)))
        return gain_of_blocks(table)

    def _estimates(self) -> Iterator[Estimate]:
        """Yield the parameters; their intervals are the jackknife's, over the quarters."""
        share = float(t.ppf(0.975, FOLDS - 1) * np.sqrt((FOLDS - 1.0) / FOLDS))
        for p in self.applied.effect.parameters:
            value = self.applied.values[p.name]
            others = np.array(
                [fold.applied.values[p.name] for fold in self.judged.folds if fold.applied]
            )
            half = share * float(np.linalg.norm(others - others.mean()))
            low, high = max(value - half, p.low), min(value + half, p.high)
            yield Estimate(p.name, value, low, high, p.unit, p.what)

    def _trace(self, trace: Trace) -> Trace:
        """Show the model as given beside the new one."""
        for s in self.stretches:
            if s.name == trace.name and s.context.t_s[0] == trace.t_s[0]:
                simulated = np.interp(trace.t_s, s.context.t_s, s.simulated_rad_s)
                return replace(trace, simulated_rad_s=simulated)
        return trace


def identified_anew(
    stretches: Sequence[Stretch], model: HammersteinModel, effects: Sequence[Effect]
) -> Anew | None:
    """Identify a model anew where a cause may lie beneath it.

    Parameters
    ----------
    stretches
        The runs.
    model
        The model.
    effects
        The library.

    Returns
    -------
    Anew or None
        None where no cause lies beneath, where it does not predict better, or where the model has
        several operating points or effects of its own.
    """
    some = first_windows(stretches, _MOST_ROWS)
    if len(model.points) > 1 or model.effects:
        return None
    contexts, measured = [s.context for s in some], [s.speed_rad_s for s in some]
    simulated = [s.simulated_rad_s for s in some]
    beneath = [e for e in effects if e.beneath(contexts, measured, simulated)]
    if not beneath:
        return None
    plains = [cross_validate(some, fit) for fit in plain_fits(some, model)]
    plain = best = min(plains, key=lambda judged: judged.mean_square)
    for fit in (fit for effect in beneath for fit in fits_beneath(some, model, effect)):
        judged = cross_validate(some, fit)
        if _SIMPLER * judged.mean_square < best.mean_square:
            best = judged
    p_value = _p_value(some, plain, best)
    if best.fit.applied is None or p_value > SIGNIFICANT:
        return None
    anew = Anew(tuple(some), _extended(model, best.fit), best.fit.applied, best, p_value)
    return anew if anew.gain(0.0).gain > 0.0 else None


def _p_value(stretches: Sequence[Stretch], plain: CrossValidated, best: CrossValidated) -> float:
    """Probability of as much less on unseen blocks by chance: a t test over their ratios."""
    table = np.zeros((2, BLOCKS))
    for s, before, after in zip(stretches, plain.unseen_rad_s, best.unseen_rad_s, strict=True):
        table += _sums(s, (before**2, after**2))
    judged = np.all(table > 0.0, axis=0)
    less = np.log(table[0, judged] / table[1, judged])
    return float(ttest_1samp(less, 0.0, alternative="greater").pvalue)


def _extended(model: HammersteinModel, fit: Estimated) -> HammersteinModel:
    """Put a fit in a model's place; what was known of the model's errors is no longer true."""
    noise_rad_s = float(np.sqrt(fit.mean_square))
    point = replace(
        model.points[0],
        curve=fit.curve,
        dead_zone_deg=dead_zone_deg(fit.curve),
        noise_rad_s=noise_rad_s,
    )
    return replace(
        model,
        linear=fit.linear,
        points=(point,),
        residual={"rmse_free_run_rad_s": noise_rad_s},
        intervals={},
        unexplained=(),
        effects=() if fit.applied is None else (fit.applied.to_mapping(),),
    )


def _sums(stretch: Stretch, values: Sequence[Array]) -> Array:
    """Sum values over the rows to judge of each block, shape (len(values), K)."""
    block = block_of(stretch)[stretch.use]
    parts = [np.bincount(block, weights=v[stretch.use], minlength=BLOCKS) for v in values]
    return np.array(parts)
