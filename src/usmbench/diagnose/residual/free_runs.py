"""Free runs with effects, over and over: what comes after the shaft does not run it again.

Nor does the same scan by another noise. A scan comes back in the same order, each time by another
noise or other rows, between steps that never come back: so what is run together is kept for good,
as much of it as there is memory for, and of single courses of the shaft the last ones.
"""

from collections.abc import Sequence
from copy import copy

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.residual.own_gone import first_gone
from usmbench.model.applied import Applied
from usmbench.model.extended import counted, shaft_speeds

Array = NDArray[np.float64]

_AFTER = ("motion", "counter")
_KEPT, _LAST = 30_000_000, 64  # speeds, 240 MB; courses

Key = tuple[tuple[object, ...], ...]


class FreeRuns:
    """Simulated speeds of stretches, with courses of the shaft kept.

    Parameters
    ----------
    stretches
        The runs.
    """

    def __init__(self, stretches: Sequence[Stretch]):
        self._contexts = self._turned = [s.context for s in stretches]
        self._rows = sum(c.n for c in self._contexts)
        self._room = _KEPT // self._rows
        self._together: dict[tuple[Key, ...], Array] = {}
        self._last: dict[Key, list[Array]] = {}

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
        gone = first_gone(effects)
        if gone is not None:
            share, rest, without = gone
            pairs = zip(self.speed_rad_s(rest), self.speed_rad_s(without), strict=True)
            return [(1.0 - share) * there + share * away for there, away in pairs]
        before = _before(effects)
        shaft = self._shaft_rad_s(before)
        if len(before) == len(effects):
            return shaft
        return [counted(effects, s, c) for s, c in zip(shaft, self._turned, strict=True)]

    def together_rad_s(self, many: Sequence[Sequence[Applied]]) -> Array:
        """Return the speeds that are reported of several motors, all stretches in one, (N, M).

        Parameters
        ----------
        many
            All effects of each motor, the model's own among them.
        """
        key = tuple(_key(effects) for effects in many)
        found = self._together.get(key)
        if found is None:
            found = np.empty((self._rows, len(many)))
            for k, effects in enumerate(many):
                np.concatenate(self.speed_rad_s(effects), out=found[:, k])
            # What comes after the shaft takes no time, and goes by an angle of its own.
            lasting = all(len(_before(effects)) == len(effects) for effects in many)
            if lasting and len(many) <= self._room:
                self._room -= len(many)
                self._together[key] = found
        return found

    def _shaft_rad_s(self, effects: Sequence[Applied]) -> list[Array]:
        """Return the shaft's speed, from memory where it ran just before with the same effects."""
        key = _key(effects)
        found = self._last.pop(key, None)
        if found is None:
            found = shaft_speeds(effects, self._contexts)
        self._last[key] = found
        if len(self._last) > _LAST:
            del self._last[next(iter(self._last))]
        return found


def _before(effects: Sequence[Applied]) -> list[Applied]:
    """Return the effects that act up to the motor's shaft."""
    return [a for a in effects if a.effect.stage not in _AFTER]


def _key(effects: Sequence[Applied]) -> Key:
    """Return what tells effects with their values from others."""
    return tuple((a.effect, *sorted(a.values.items())) for a in effects)
