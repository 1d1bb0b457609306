"""What a model may leave in its residual without anything being wrong: a linear family of columns.

Each column is a shape; how much of it the model leaves, and how sure that is, is measured on the
runs that it was identified on.

========= ==========================================================================
group     shape
========= ==========================================================================
phase     a hat over φ: the curve's own error
direction the same, with the sign of the last move: what depends on where φ came from
time      the speed, times a hat over time: the motor warms in every run
heat      the speed, times the power it has taken so far: and warms by how it is driven
lag k     the step, k windows after it, times hats over the speeds it leads from and to
angle     the speed, times a wave once and twice a revolution
========= ==========================================================================
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.noise import LAGS
from usmbench.diagnose.stretches import Stretch

Array = NDArray[np.float64]

_PHASE_NODES, _TIME_NODES = 25, 8
_CELLS = (7, 5, 3, 2, 2, 2)  # nodes along each speed at each lag
_REACH = 0.25  # share of the known time by which a line in time is carried on
GROUPS = ("phase", "direction", "time", "heat", *(f"lag {k}" for k in range(LAGS)), "angle")
# Largest plausible share of each shape in a model that is right: standard deviations, as shares
# of the highest speed (phase, direction), of the speed, or of the step.
PRIOR = {
    "phase": 3e-3,
    "direction": 3e-3,
    "time": 5e-3,
    "heat": 5e-3,
    **dict.fromkeys((f"lag {k}" for k in range(LAGS)), 0.05),
    "angle": 2e-3,
}


@dataclass(frozen=True, slots=True)
class Features:
    """The columns' scales.

    Parameters
    ----------
    low_deg, high_deg
        Phases that the model was identified on.
    top_rad_s
        Highest speed of the model.
    end_s
        Time up to which the runs reached that the model was identified on.
    """

    low_deg: float
    high_deg: float
    top_rad_s: float
    end_s: float

    @property
    def groups(self) -> list[str]:
        """Group of every column, in the order of `columns`."""
        counts = [_PHASE_NODES, _PHASE_NODES, _TIME_NODES, 1, *(n * n for n in _CELLS), 4]
        return [g for g, n in zip(GROUPS, counts, strict=True) for _ in range(n)]

    @property
    def prior(self) -> Array:
        """Standard deviation of every coefficient before any run was seen, shape (K,)."""
        scale = {"phase": self.top_rad_s, "direction": self.top_rad_s}
        return np.array([PRIOR[g] * scale.get(g, 1.0) for g in self.groups])

    def columns(self, stretch: Stretch) -> Iterator[Array]:
        """Yield the columns on one stretch, shape (N,) each.

        Parameters
        ----------
        stretch
            The stretch.
        """
        speed = stretch.simulated_rad_s
        phase_deg = np.clip(stretch.context.phase_deg, self.low_deg, self.high_deg)
        over_phase = list(hats(phase_deg, np.linspace(self.low_deg, self.high_deg, _PHASE_NODES)))
        yield from over_phase
        yield from (column * stretch.direction for column in over_phase)
        t_s = np.minimum(stretch.context.t_s, (1.0 + _REACH) * self.end_s)
        for column in hats(t_s, np.linspace(0.0, self.end_s, _TIME_NODES)):
            yield column * speed
        power = (speed / self.top_rad_s) ** 2 - 0.5
        yield speed * np.cumsum(power) * stretch.context.window_s / self.end_s
        yield from self._after_steps(stretch)
        angle_rad = stretch.context.angle_rad
        for harmonic in (1, 2):
            for wave in (np.cos, np.sin):
                yield (
                    np.zeros_like(speed)
                    if angle_rad is None
                    else speed * wave(harmonic * angle_rad)
                )

    def _after_steps(self, stretch: Stretch) -> Iterator[Array]:
        """Yield the steps by the speeds that they lead from and to."""
        after = np.clip(stretch.settled_rad_s / self.top_rad_s, -1.0, 1.0)
        before = np.clip(after - stretch.step_rad_s / self.top_rad_s, -1.0, 1.0)
        for lag, n_nodes in enumerate(_CELLS):
            nodes = np.linspace(-1.0, 1.0, n_nodes)
            step = stretch.step_rad_s * (stretch.lag == lag)
            ends = list(hats(after, nodes))
            for start in hats(before, nodes):
                yield from (step * start * end for end in ends)

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
            "low_deg": self.low_deg,
            "high_deg": self.high_deg,
            "top_rad_s": self.top_rad_s,
            "end_s": self.end_s,
        }


def features_of(stretches: Sequence[Stretch]) -> Features:
    """Return the family for the runs that a model was identified on.

    Parameters
    ----------
    stretches
        The runs.
    """
    phase_deg = [s.context.phase_deg for s in stretches]
    return Features(
        min(float(p.min()) for p in phase_deg),
        max(float(p.max()) for p in phase_deg),
        max(max(float(np.max(np.abs(s.settled_rad_s))) for s in stretches), 1e-9),
        max(float(s.context.t_s[-1]) for s in stretches),
    )


def hats(values: Array, nodes: Array) -> Iterator[Array]:
    """Yield the hat function of each node; beyond the last two nodes their line goes on.

    Parameters
    ----------
    values
        Where, shape (N,).
    nodes
        Evenly spaced, rising.
    """
    place = (values - nodes[0]) / (nodes[1] - nodes[0])
    left = np.clip(np.floor(place), 0, nodes.size - 2)
    share = np.maximum(place - left, 0.0)
    for k in range(nodes.size):
        yield np.where(left == k, 1.0 - share, 0.0) + np.where(left == k - 1, share, 0.0)
