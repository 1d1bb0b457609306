"""The smallest size of each cause that the runs would have shown."""

import math
from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq
from scipy.stats import norm

from usmbench.diagnose.evidence import Detectable
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.naming.ranking import CLEAR, Ranked
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Effect
from usmbench.model.effects.parameter import Parameter

_POWER = 0.9
_MOST = 1e3  # deviance that no chance reaches
_DOUBLINGS = 14


def smallest_sizes(
    problem: Problem, effects: Sequence[Effect], spread: float, ranked: Sequence[Ranked] = ()
) -> tuple[Detectable, ...]:
    """Return, by cause, the size at which its deviance is found with 90 % power.

    Of the forms that a cause has in one unit it is the one that shows least: a weight shows as
    soon as the rotor rests, a drag as large may not.

    Parameters
    ----------
    problem
        The problem.
    effects
        Testable effects.
    spread
        Standard deviation of the whitened noise.
    ranked
        Every cause alone: what its scan costs it. One that is missing is taken to have none.
    """
    roughness = {r.effect: r.fit.roughness for r in ranked}
    found: dict[str, Detectable] = {}
    for effect in effects:
        if effect.sporadic or not effect.parameters:
            continue
        sized = next((p for p in effect.parameters if not p.scanned), effect.parameters[0])
        before = found.get(effect.name)
        if before is not None and before.unit != sized.unit:
            continue
        threshold = _threshold(effect, CLEAR / len(effects), roughness.get(effect, 0.0))
        wanted = (math.sqrt(threshold) + float(norm.ppf(_POWER))) ** 2 * spread**2
        value = _size(problem, effect, sized, wanted)
        if value is not None and (before is None or value > before.value):
            found[effect.name] = Detectable(effect.name, sized.name, value, sized.unit)
    return tuple(found.values())


def _threshold(effect: Effect, p_value: float, roughness: float) -> float:
    """Statistic at which an effect alone has a probability, its scan paid for."""
    applied = (Applied(effect, {}),)
    return float(brentq(lambda u: Fit(applied, u, roughness).p_value - p_value, 0.0, _MOST))


def _size(problem: Problem, effect: Effect, sized: Parameter, wanted: float) -> float | None:
    """Double the size until it shows, then interpolate in its square root."""
    window_s = problem.stretches[0].context.window_s
    grids = effect.grid([s.context for s in problem.stretches])
    shape = {p.name: float(np.median(grids.get(p.name, p.null))) for p in effect.parameters}

    def energy(size: float) -> float:
        values = {**shape, sized.name: sized.null + size}
        return problem.square(problem.change_rad_s([Applied(effect, values)]))

    if energy(0.0) >= wanted:
        return None  # it shows at any size
    low, low_energy = 0.0, 0.0
    size = sized.typical / 64.0
    for _ in range(_DOUBLINGS):
        size = min(size, sized.high - sized.null)
        here = energy(size)
        if here >= wanted:
            share = (math.sqrt(wanted) - math.sqrt(low_energy)) / (
                math.sqrt(here) - math.sqrt(low_energy)
            )
            return max(low + share * (size - low), sized.least_windows * window_s)
        if size >= sized.high - sized.null:
            return None
        low, low_energy, size = size, here, 2.0 * size
    return None
