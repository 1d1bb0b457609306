"""Free runs with effects, over and over: what comes after the shaft does not run it again.

Nor does the same scan by another noise, unless the runs are long: then memory counts for more.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.model.extended import Applied, counted, shaft_run

Array = NDArray[np.float64]

_AFTER = ("motion", "counter")
# A search through the library over 1e4 windows has up to 2000 courses; of fewer kept, each is lost
# before it is asked for again.
_KEPT, _FEWEST = 20_000_000, 4  # speeds, 160 MB; courses


class FreeRuns:
    """Simulated speeds of stretches, with the shaft's last courses kept.

    Parameters
    ----------
    stretches
        The runs.
    """

    def __init__(self, stretches: Sequence[Stretch]):
        self._contexts = [s.context for s in stretches]
        self._most = max(_KEPT // sum(c.n for c in self._contexts), _FEWEST)
        self._shaft: dict[tuple[object, ...], list[Array]] = {}

    def speed_rad_s(self, effects: Sequence[Applied]) -> list[Array]:
        """Return the speed that is reported, by stretch, shape (N,) each.

        Parameters
        ----------
        effects
            All effects, the model's own among them.
        """
        shaft = self._shaft_rad_s([a for a in effects if a.effect.stage not in _AFTER])
        return [counted(effects, s, c) for s, c in zip(shaft, self._contexts, strict=True)]

    def _shaft_rad_s(self, effects: Sequence[Applied]) -> list[Array]:
        """Return the shaft's speed, from memory where it ran last with the same effects."""
        key = tuple((a.effect, *sorted(a.values.items())) for a in effects)
        found = self._shaft.pop(key, None)
        if found is None:
            found = [shaft_run(effects, c).speed_rad_s for c in self._contexts]
        self._shaft[key] = found
        if len(self._shaft) > self._most:
            del self._shaft[next(iter(self._shaft))]
        return found
