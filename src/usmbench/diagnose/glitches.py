"""False counts named: windows that stand alone, more of them than chance allows."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, poisson

from usmbench.diagnose.naming import SIGNIFICANT
from usmbench.diagnose.problem import Problem
from usmbench.diagnose.result import Estimate, NamedCause
from usmbench.diagnose.spikes import PLAIN, spiked, steady
from usmbench.model.effects.registry import library
from usmbench.model.extended import Applied

Array = NDArray[np.float64]

_FEWEST = 4
_AS_USUAL = 2.0  # times the rate of the identified runs: their plans differ
_MOST_SHARE = 0.1  # more than every tenth window is no isolated event


@dataclass(frozen=True, slots=True)
class Glitches:
    """The finding.

    Parameters
    ----------
    applied
        The effect for the extended model.
    named
        The cause for the result.
    """

    applied: Applied
    named: NamedCause


def find_glitches(problem: Problem, left: Sequence[Array]) -> Glitches | None:
    """Name false counts where enough windows stand alone.

    Parameters
    ----------
    problem
        The problem.
    left
        Residual of each stretch without the other causes.
    """
    effects = [effect for effect in library() if effect.sporadic]
    far = spiked(problem.stretches, left, problem.noise, near_steps=True, times=PLAIN)
    uses = [steady(s) for s in problem.stretches]
    hit = np.concatenate([f[u] for f, u in zip(far, uses, strict=True)])
    count = int(np.count_nonzero(hit))
    run_s = hit.size * problem.stretches[0].context.window_s
    usual = _AS_USUAL * problem.known.spikes_hz * run_s
    p_value = float(poisson.sf(count - 1, usual)) if usual > 0.0 else 0.0
    few = count < max(_FEWEST, usual) or p_value > SIGNIFICANT
    if not effects or few or count > _MOST_SHARE * hit.size:
        return None
    size = np.abs(np.concatenate([r[u] for r, u in zip(left, uses, strict=True)])[hit])
    # Exact Poisson interval (Garwood 1936) for the rate, the spread of the sizes for the size.
    low, high = 0.5 * chi2.ppf(0.025, 2 * count), 0.5 * chi2.ppf(0.975, 2 * count + 2)
    middle = float(np.median(size))
    half = 1.96 * float(np.std(size)) / np.sqrt(count)
    effect = effects[0]
    estimates = (
        Estimate("rate_hz", count / run_s, float(low) / run_s, float(high) / run_s, "1/s"),
        Estimate("size_rad_s", middle, max(middle - half, 0.0), middle + half, "rad/s"),
    )
    values = {e.name: e.value for e in estimates}
    energy = float(np.sum(size**2))
    rest = sum(float(np.sum(r[u] ** 2)) for r, u in zip(left, uses, strict=True))
    named = NamedCause(
        effect.name,
        effect.form,
        effect.meaning,
        effect.mend,
        (),
        estimates,
        p_value,
        energy / max(rest, 1e-12),
    )
    return Glitches(Applied(effect, values), named)
