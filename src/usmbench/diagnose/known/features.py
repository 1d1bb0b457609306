"""What a model may leave in its residual without anything being wrong: a linear family of columns.

Each column is a shape; how much of it the model leaves, and how sure that is, is measured on the
runs that it was identified on.

========= ==========================================================================
group     shape
========= ==========================================================================
phase     a hat over φ, at each operating point, behind the linear part: the curve's own error
direction the same, with the sign of the last move: what depends on where φ came from
time      the speed, times how long the motor is driven, through thermal lags: it warms in every run
heat      the speed, times the power it has taken so far, likewise: and warms by how it is driven
friction  both again, of what friction takes more, and again times the place in frequency and torque
resonance both again, of what the resonance's move does, where the model knows several frequencies
lag k     the step, k windows after it, times hats over the speeds it leads from and to; again
          times the place in frequency and torque: the lag changes along the resonance
late      what commands that act later change: after steps that lie close, more than the lags hold
braking   what a longer time constant changes where the motor slows down, and there only
edge      what a dead zone wider by a share changes, likewise over time, places: it widens by heat
start     a speed lost near standstill, after each kind of step, and again times the place in
          frequency and torque; and a dead zone that is wider outward bound: a rotor sticks
angle     the speed, times a wave once and twice a revolution
========= ==========================================================================
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.braking import braking_slower
from usmbench.diagnose.known.phase_nodes import PHASE_NODES
from usmbench.diagnose.known.shapes import (
    detuned_rad_s,
    felt,
    held_back,
    later_rad_s_per_s,
    shown,
    widening,
    widening_by_share,
)
from usmbench.diagnose.known.step_columns import (
    CELLS,
    N_NEAR_STANDSTILL,
    after_steps,
    near_standstill,
)
from usmbench.diagnose.noise.noise_model import LAGS
from usmbench.model.polygon import hats

Array = NDArray[np.float64]

_LAG_GROUPS = tuple(f"lag {k}" for k in range(LAGS))
GROUPS = (
    "phase",
    "direction",
    "time",
    "heat",
    "friction",
    "resonance",
    "edge",
    "late",
    "braking",
    *_LAG_GROUPS,
    "start",
    "angle",
)
WARMING = ("time", "heat", "friction", "resonance", "edge")
"""Groups that stand in a row, for what warming changes."""
# Largest plausible share of each shape in a model that is right: standard deviations, as shares
# of the highest speed (phase, direction, friction, resonance), of the speed, or of the step; of
# lateness, in s; of the time constant.
PRIOR = {
    "phase": 3e-3,
    "direction": 1e-3,
    "time": 1e-2,
    "heat": 1e-2,
    "friction": 1e-2,
    "resonance": 5e-2,
    "edge": 2e-2,
    "late": 1e-4,
    "braking": 0.1,
    **dict.fromkeys(_LAG_GROUPS, 0.05),
    "start": 0.2,
    "angle": 2e-3,
}


@dataclass(frozen=True, slots=True)
class Features:
    """The columns' scales.

    Parameters
    ----------
    nodes_deg
        Phases at which the curve's error is kept, rising: denser where it is steep or bends.
    top_rad_s
        Highest speed of the model.
    n_constants
        Number of thermal time constants that tell how it warms, from the shortest on.
    n_points
        Number of the model's operating points.
    n_places
        Whether these differ in frequency, in torque (1) or in both (2).
    steepest_rad_s
        Largest change of the speed with the relative drive frequency; None where the model knows
        one frequency only.
    unmeasured_rad_s
        How far off the curve may be at each node, for lying between measured phases or having few
        rows near; none where nothing is known of that.
    between_rad_s
        How far off a straight line from each node to the next may be in a gap between measured
        phases; none where nothing is known of that.
    """

    nodes_deg: tuple[float, ...]
    top_rad_s: float
    n_constants: int = 1
    n_points: int = 1
    n_places: int = 0
    steepest_rad_s: float | None = None
    unmeasured_rad_s: tuple[float, ...] = ()
    between_rad_s: tuple[float, ...] = ()

    @property
    def groups(self) -> list[str]:
        """Group of every column, in the order of `columns`."""
        counts = [
            PHASE_NODES * self.n_points,
            PHASE_NODES,
            self.n_constants,
            self.n_constants,
            (2 + self.n_places) * self.n_constants,
            0 if self.steepest_rad_s is None else 1 + 3 * self.n_constants,
            (1 + self.n_places) * self.n_constants,
            1,
            1,
            *((1 + self.n_places) * n * n for n in CELLS),
            (1 + self.n_places) * N_NEAR_STANDSTILL + 1,
            4,
        ]
        return [g for g, n in zip(GROUPS, counts, strict=True) for _ in range(n)]

    @property
    def warms_at(self) -> NDArray[np.int64]:
        """Which thermal time constant each column goes by; -1 for none, shape (K,)."""
        groups = np.array(self.groups)
        at = np.full(groups.size, -1)
        warms = np.flatnonzero(np.isin(groups, WARMING))
        if self.steepest_rad_s is not None:  # the shift that is there from the start
            warms = warms[warms != np.argmax(groups == "resonance")]
        at[warms] = np.arange(warms.size) % self.n_constants
        return at

    @property
    def prior(self) -> Array:
        """Standard deviation of every coefficient before any run was seen, shape (K,)."""
        speeds = ("phase", "direction", "friction", "resonance")
        scale = dict.fromkeys(speeds, self.top_rad_s)
        prior = np.array([PRIOR[g] * scale.get(g, 1.0) for g in self.groups])
        if self.unmeasured_rad_s:
            n = PHASE_NODES * self.n_points
            prior[:n] = np.hypot(prior[:n], np.tile(self.unmeasured_rad_s, self.n_points))
        return prior

    def columns(self, stretch: Stretch) -> Iterator[Array]:
        """Yield the columns on one stretch, shape (N,) each.

        Parameters
        ----------
        stretch
            The stretch.
        """
        speed = stretch.simulated_rad_s
        over_phase = list(hats(stretch.context.phase_deg, np.array(self.nodes_deg)))
        for weight in (*stretch.points, stretch.direction):
            off = [column * weight for column in over_phase]
            yield from felt(stretch.context.linear, np.column_stack(off)).T
        yield from self.warming(stretch)
        yield later_rad_s_per_s(stretch)
        yield braking_slower(stretch)
        yield from after_steps(stretch, self.top_rad_s)
        yield from near_standstill(stretch, self.top_rad_s)
        yield widening(stretch, stretch.direction * np.sign(stretch.context.phase_deg))
        angle_rad = stretch.context.angle_rad
        for harmonic in (1, 2):
            for wave in (np.cos, np.sin):
                yield (
                    np.zeros_like(speed)
                    if angle_rad is None
                    else speed * wave(harmonic * angle_rad)
                )

    def warming(self, stretch: Stretch) -> Iterator[Array]:
        """Yield the columns of the groups `WARMING` on one stretch, shape (N,) each.

        Parameters
        ----------
        stretch
            The stretch.
        """
        yield from self._times_warmth(stretch, stretch.simulated_rad_s)
        held, (steady, *_, vibration) = held_back(stretch), self._warmth(stretch)
        yield from self._times_warmth(stretch, shown(stretch, held))
        for there in stretch.places:
            yield from shown(stretch, there * held) * steady
        if self.steepest_rad_s is not None:
            # A shift that is there from the start is none of the phases': its sign differs
            # between the sides of the resonance.
            moved = detuned_rad_s(stretch) / self.steepest_rad_s
            yield moved
            yield from self._times_warmth(stretch, moved)
            # The vibration heats, not the speed: it hangs on the frequency alone.
            yield from moved * (vibration / self.top_rad_s**2 - steady)
        for there in (np.ones(stretch.context.n), *stretch.places):
            yield from widening_by_share(stretch, there) * steady

    def _warmth(self, stretch: Stretch) -> Array:
        """Return the stretch's warmth at the constants that count, shape (3, C, N)."""
        return stretch.warmth[:, : self.n_constants]

    def _times_warmth(self, stretch: Stretch, shape: Array) -> Iterator[Array]:
        """Yield a shape times how long the motor is driven, and times the power taken so far."""
        steady, speed, _ = self._warmth(stretch)
        for warm in (steady, speed / self.top_rad_s - 0.5 * steady):
            yield from shape * warm

    def combined(self, stretch: Stretch, coefficients: Array) -> Array:
        """Return the columns' sum with coefficients, shape (N,).

        Parameters
        ----------
        stretch
            The stretch.
        coefficients
            One a column, shape (K,).
        """
        total = np.zeros(stretch.context.n)
        for column, coefficient in zip(self.columns(stretch), coefficients, strict=True):
            if coefficient != 0.0:
                total += coefficient * column
        return total

    def to_mapping(self) -> dict[str, Any]:
        """Return what the model file keeps."""
        return {
            "nodes_deg": list(self.nodes_deg),
            "top_rad_s": self.top_rad_s,
            "n_constants": self.n_constants,
            "n_points": self.n_points,
            "n_places": self.n_places,
            "steepest_rad_s": self.steepest_rad_s,
            "unmeasured_rad_s": list(self.unmeasured_rad_s),
            "between_rad_s": list(self.between_rad_s),
        }
