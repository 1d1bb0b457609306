"""What a fit of effects to the whitened residual came to."""

import math
from dataclasses import dataclass

from scipy.special import chdtrc

from usmbench.model.applied import Applied
from usmbench.model.effects.parameter import Parameter


@dataclass(frozen=True, slots=True)
class Fit:
    """Effects at their best values.

    Parameters
    ----------
    effects
        The effects with their values.
    statistic
        Drop of the deviance against no effect.
    roughness
        Total variation of the normalised effect over the scan, in rad, or, where part of the level
        is kept for the beginning of the scan, what comes to as much; see `p_value`.
    """

    effects: tuple[Applied, ...]
    statistic: float
    roughness: float

    @property
    def sized(self) -> list[Parameter]:
        """Parameters that size the effects."""
        return [p for a in self.effects for p in a.effect.parameters if not p.scanned]

    @property
    def p_value(self) -> float:
        """Probability of such a statistic where nothing is wrong, for this effect alone.

        For a scanned parameter, Davies' bound on the supremum of a chi process with as many degrees
        of freedom s as there are sizes (1987, doi:10.1093/biomet/74.1.33): the tail at one point,
        plus the variation times ``(u/2)^((s−1)/2) exp(−u/2) / (√π Γ(s/2))``. Of an effect with one
        size and one sign chance takes the wrong one half of the time (Chernoff 1954,
        doi:10.1214/aoms/1177728725).
        """
        u, sized = max(self.statistic, 0.0), self.sized
        half, n = 0.5 * u, max(len(sized), 1)
        tail = float(chdtrc(n, u))
        crossed = math.pow(half, 0.5 * (n - 1)) * math.exp(-half)
        crossed /= math.sqrt(math.pi) * math.gamma(0.5 * n)
        tail += self.roughness * crossed
        sides = 0.5 if u > 0.0 and len(sized) == 1 and sized[0].one_way else 1.0
        return min(sides * tail, 1.0)

    @property
    def searched(self) -> float:
        """Deviance that pays for the scan: chance brings as much so much more often than without.

        Twice the logarithm of by how much the scan raises `p_value`, the tail of chi-squared taken
        as what it tends to.
        """
        half = 0.5 * max(self.statistic, 0.0)
        return 2.0 * math.log1p(self.roughness * math.sqrt(max(half, 1.0) / math.pi))


NOTHING = Fit((), 0.0, 0.0)
