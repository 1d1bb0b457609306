"""Free runs with effects, over and over: what comes after the shaft does not run it again.

Nor does the same scan by another noise. A scan comes back in the same order, each time by another
noise or other rows, between steps that never come back: so the first courses are kept for good, as
many as there is memory for, and of the others the last ones.
"""

from collections.abc import Sequence
from copy import copy

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.model.extended import Applied, counted, shaft_speeds

Array = NDArray[np.float64]

_AFTER = ("motion", "counter")
_KEPT, _LAST = 30_000_000, 4  # speeds, 240 MB; courses


class FreeRuns:
    """Simulated speeds of stretches, with courses of the shaft kept.

    Parameters
    ----------
    stretches
        The runs.
    """

    def __init__(self, stretches: Sequence[Stretch]):
        self._contexts = self._turned = [s.context for s in stretches]
        self._most = _KEPT // sum(c.n for c in self._contexts)
        self._first: dict[tuple[object, ...], list[Array]] = {}
        self._last: dict[tuple[object, ...], list[Array]] = {}

    def turned(self, stretches: Sequence[Stretch]) -> "FreeRuns":
        """Return the same runs, whose shaft is known to have had another angle.

        What acts before the counter goes by the angle that was counted, as in `extended_run`.

        Parameters
        ----------
        stretches
            The runs with that angle.
        """
        other = copy(self)
        other._turned = [s.context for s in stretches]
        return other

    def speed_rad_s(self, effects: Sequence[Applied]) -> list[Array]:
        """Return the speed that is reported, by stretch, shape (N,) each.

        Parameters
        ----------
        effects
            All effects, the model's own among them.
        """
        before = [a for a in effects if a.effect.stage not in _AFTER]
        shaft = self._shaft_rad_s(before)
        if len(before) == len(effects):
            return shaft
        return [counted(effects, s, c) for s, c in zip(shaft, self._turned, strict=True)]

    def _shaft_rad_s(self, effects: Sequence[Applied]) -> list[Array]:
        """Return the shaft's speed, from memory where it ran before with the same effects."""
        key = tuple((a.effect, *sorted(a.values.items())) for a in effects)
        found = self._first.get(key) or self._last.pop(key, None)
        if found is None:
            found = shaft_speeds(effects, self._contexts)
        if len(self._first) < self._most:
            self._first[key] = found
        elif key not in self._first:
            self._last[key] = found
            if len(self._last) > _LAST:
                del self._last[next(iter(self._last))]
        return found
