"""What a model may leave in its residual without anything being wrong: a linear family of columns.

Each column is a shape; how much of it the model leaves, and how sure that is, is measured on the
runs that it was identified on.

========= ==========================================================================
group     shape
========= ==========================================================================
phase     a hat over φ, at each operating point, behind the linear part: the curve's own error
direction the same, with the sign of the last move: what depends on where φ came from
time      the speed, times a hat over time: the motor warms in every run
heat      the speed, times the power it has taken so far: and warms by how it is driven
resonance both again, of what the resonance's move does, where the model knows several frequencies
lag k     the step, k windows after it, times hats over the speeds it leads from and to; again
          times the place in frequency and torque: the lag changes along the resonance
late      what commands that act later change: after steps that lie close, more than the lags hold
edge      what a wider dead zone changes, times a hat over time: it widens as the motor warms
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
from usmbench.diagnose.known.shapes import (
    PHASE_NODES,
    detuned_rad_s,
    felt,
    highest_rad_s,
    later_rad_s_per_s,
    widening,
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

_TIME_NODES, _EDGE_NODES = 8, 4
_REACH = 0.25  # share of the known time by which a line in time is carried on
_LAG_GROUPS = tuple(f"lag {k}" for k in range(LAGS))
GROUPS = (
    "phase",
    "direction",
    "time",
    "heat",
    "resonance",
    "edge",
    "late",
    *_LAG_GROUPS,
    "start",
    "angle",
)
# Largest plausible share of each shape in a model that is right: standard deviations, as shares
# of the highest speed (phase, direction), of the speed, or of the step; of lateness, in s.
PRIOR = {
    "phase": 3e-3,
    "direction": 1e-3,
    "time": 5e-3,
    "heat": 2e-2,
    "resonance": 2e-2,
    "edge": 0.2,
    "late": 1e-4,
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
    end_s
        Time up to which the runs reached that the model was identified on.
    n_points
        Number of the model's operating points.
    n_places
        Whether these differ in frequency, in torque (1) or in both (2).
    steepest_rad_s
        Largest change of the speed with the relative drive frequency; None where the model knows
        one frequency only.
    unmeasured_rad_s
        How far off the curve may be at each node for lying between measured phases; none for
        phases that lie close.
    """

    nodes_deg: tuple[float, ...]
    top_rad_s: float
    end_s: float
    n_points: int = 1
    n_places: int = 0
    steepest_rad_s: float | None = None
    unmeasured_rad_s: tuple[float, ...] = ()

    @property
    def groups(self) -> list[str]:
        """Group of every column, in the order of `columns`."""
        counts = [
            PHASE_NODES * self.n_points,
            PHASE_NODES,
            _TIME_NODES - 1,
            2,
            0 if self.steepest_rad_s is None else _TIME_NODES + 3,
            _EDGE_NODES - 1,
            1,
            *((1 + self.n_places) * n * n for n in CELLS),
            (1 + self.n_places) * N_NEAR_STANDSTILL + 1,
            4,
        ]
        return [g for g, n in zip(GROUPS, counts, strict=True) for _ in range(n)]

    @property
    def warms(self) -> NDArray[np.bool_]:
        """Which columns grow as the motor warms, shape (K,)."""
        groups = self.groups
        grow = np.isin(groups, ("time", "heat", "resonance", "edge"))
        if "resonance" in groups:
            grow[groups.index("resonance")] = False  # a shift that is there from the start
        return grow

    @property
    def prior(self) -> Array:
        """Standard deviation of every coefficient before any run was seen, shape (K,)."""
        scale = dict.fromkeys(("phase", "direction", "resonance"), self.top_rad_s)
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
        yield from self._warming(stretch, speed)
        if self.steepest_rad_s is not None:
            # A shift that is there from the start is none of the phases': its sign differs
            # between the sides of the resonance.
            moved = detuned_rad_s(stretch) / self.steepest_rad_s
            yield moved
            yield from self._warming(stretch, moved)
            # The vibration heats, not the speed: it hangs on the frequency alone.
            vibration = highest_rad_s(stretch) / self.top_rad_s
            before = stretch.before
            so_far = before.highest_squared_rad2_s2 / self.top_rad_s**2 - before.windows
            yield moved * self._taken(stretch, vibration**2 - 1.0, so_far)
        wider = widening(stretch)
        yield from (column * wider for column in self._over_time(stretch, _EDGE_NODES))
        yield later_rad_s_per_s(stretch)
        yield from after_steps(stretch, self.top_rad_s)
        yield from near_standstill(stretch, self.top_rad_s)
        yield wider * stretch.direction * np.sign(stretch.context.phase_deg)
        angle_rad = stretch.context.angle_rad
        for harmonic in (1, 2):
            for wave in (np.cos, np.sin):
                yield (
                    np.zeros_like(speed)
                    if angle_rad is None
                    else speed * wave(harmonic * angle_rad)
                )

    def _warming(self, stretch: Stretch, shape: Array) -> Iterator[Array]:
        """Yield a shape times hats over time, and times the power taken so far."""
        yield from (column * shape for column in self._over_time(stretch, _TIME_NODES))
        before, size = stretch.before, np.abs(stretch.simulated_rad_s) / self.top_rad_s
        sizes = before.speed_rad_s / self.top_rad_s
        squares = before.squared_rad2_s2 / self.top_rad_s**2
        yield shape * self._taken(stretch, size - 0.5, sizes - 0.5 * before.windows)
        yield shape * self._taken(stretch, size**2 - size, squares - sizes)

    def _taken(self, stretch: Stretch, power: Array, before: float) -> Array:
        """Return the power taken since the run began, in shares of the known time, shape (N,)."""
        return (before + np.cumsum(power)) * stretch.context.window_s / self.end_s

    def _over_time(self, stretch: Stretch, n_nodes: int) -> Iterator[Array]:
        """Yield hats over time but the first: what is there from the start belongs to the phases.

        Beyond the known time the last line goes on for a while.
        """
        t = stretch.context.t_s / self.end_s
        beyond = np.clip(t - 1.0, 0.0, _REACH) * (n_nodes - 1)
        for k, column in enumerate(hats(t, np.linspace(0.0, 1.0, n_nodes))):
            if k > 0:
                yield column + {n_nodes - 2: -1.0, n_nodes - 1: 1.0}.get(k, 0.0) * beyond

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

    def warming(self, stretch: Stretch, warms_rad_s: Array) -> Array:
        """Return a known warming, and the same growing over the known time, shape (N, 2).

        Parameters
        ----------
        stretch
            The stretch.
        warms_rad_s
            What the motor is known to change as it warms, shape (N,).
        """
        later = 2.0 * stretch.context.t_s / self.end_s - 1.0
        return np.column_stack((warms_rad_s, warms_rad_s * later))

    def to_mapping(self) -> dict[str, Any]:
        """Return what the model file keeps."""
        return {
            "nodes_deg": list(self.nodes_deg),
            "top_rad_s": self.top_rad_s,
            "end_s": self.end_s,
            "n_points": self.n_points,
            "n_places": self.n_places,
            "steepest_rad_s": self.steepest_rad_s,
            "unmeasured_rad_s": list(self.unmeasured_rad_s),
        }
