"""The noise of a free-running residual: its size by phase, its colour, and the steps' jitter.

The residual is taken as ``e_t = σ(φ) n_t + κ_kc(|s|) w_t``, k windows after a step of s in the
settled speed, with n an autoregressive process of unit variance, w white, and c the kind of the
step: from running to running the same way, into a stop, out of one, or through one, which is a
reversal. κ is the moment at which a command takes effect within a window, which no free run can
know, and grows with the step; and that at which a stopping rotor sticks or a standing one comes
free, which hardly does. At the edge of the dead zone a rotor comes free at once or not at all:
there κ has a part of its own, by the speed that half a degree more would give. A share of κ returns
whenever a plan repeats a jump: it is the model's error, and no chance, and R repeats tell of it
once. While a rotor runs out in the dead zone, σ is at least a share of that where it was driven.
"""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.noise.rotor_states import (
    KINDS,
    REVERSAL,
    bend_rad_s,
    farther_out,
    runs_out,
    step_kind,
    turns,
)
from usmbench.model.linear import poles

Array = NDArray[np.float64]

LAGS = 6
# From small steps nobody knows when a large one takes effect: a share of the step, 50 µs of 10 ms,
# beyond so many times the largest quarter's mean, in these windows after it.
_UNSEEN, FARTHER, _AT_ONCE = 5e-3, 1.5, (0, 1)
# How near an edge a phase lies, where a rotor comes free on one day only, is told on a rising grid.
# It only resolves; nothing measured sets it.
STARTS = (0.0025, 0.01, 0.0225, 0.045)  # of the highest speed, reached half a degree farther out


@dataclass(frozen=True, slots=True)
class Noise:
    """The noise of a bench.

    Parameters
    ----------
    phase_deg, sigma_rad_s
        Standard deviation σ at some phases (rising), shape (K,).
    ar
        Coefficients of n_t = Σ ar_i n_{t−i} + innovation, shape (p,).
    innovation
        Standard deviation of the innovation.
    step_rad_s, step_spread_rad_s
        Sizes |s| of a step (rising) and κ at these, shape (LAGS, KINDS, sizes).
    start_rad_s
        What the edge of the dead zone adds, shape (len(STARTS),), where the speed half a degree
        farther out is as `STARTS` lists.
    same_again
        Correlation of what the same jump leaves another time, at each lag, shape (LAGS,).
    running_out
        Share of the noise of a rotor that turns, in one that runs out in the dead zone.
    """

    phase_deg: Array
    sigma_rad_s: Array
    ar: Array
    innovation: float
    step_rad_s: Array
    step_spread_rad_s: Array
    start_rad_s: Array
    same_again: Array
    running_out: float = 0.0

    def level_rad_s(self, stretch: Stretch) -> Array:
        """Return the standard deviation on each row of a stretch.

        Parameters
        ----------
        stretch
            The stretch.
        """
        size, kind = np.abs(stretch.step_rad_s), step_kind(stretch)
        spread = np.zeros(size.size)
        for k, c in np.ndindex(LAGS, KINDS):
            rows = (stretch.lag == k) & (kind == c)
            sizes, spreads = self.step_rad_s[k, c], self.step_spread_rad_s[k, c]
            # A rotor that turns back stands still in between, from and to whatever speed.
            least = spreads[0] if c == REVERSAL else 0.0
            nodes, values = np.r_[0.0, sizes], np.r_[least, spreads]
            beyond = np.maximum(size[rows] / max(nodes[-1], 1e-300), 1.0)
            spread[rows] = np.interp(size[rows], nodes, values) * beyond
            if k in _AT_ONCE:
                spread[rows] += _UNSEEN * np.maximum(size[rows] - FARTHER * nodes[-1], 0.0)
        at_edge = np.interp(
            farther_out(stretch), (0.0, *STARTS, 2.0 * STARTS[-1]), (0.0, *self.start_rad_s, 0.0)
        )
        returning = self.same_again[np.minimum(stretch.lag, LAGS - 1)] * (stretch.again - 1)
        erring = (spread**2 + at_edge**2) * (1.0 + returning)
        calm = self.calm_rad_s(stretch)
        unsure = bend_rad_s(stretch) ** 2 + stretch.moment_rad_s**2 + stretch.scatter_rad_s**2
        level: Array = np.sqrt(calm**2 + erring + unsure)
        return level

    def calm_rad_s(self, stretch: Stretch) -> Array:
        """Return the standard deviation on each row far from steps and edges, σ(φ).

        A rotor that runs out in the dead zone has a share of what it had where it was last driven.

        Parameters
        ----------
        stretch
            The stretch.
        """
        running_out = self.running_out * self.last_driven_rad_s(stretch)
        return np.maximum(self._at_phases_rad_s(stretch), running_out)

    def last_driven_rad_s(self, stretch: Stretch) -> Array:
        """Return the noise where a rotor that runs out was last driven, 0 on other rows, (N,).

        Parameters
        ----------
        stretch
            The stretch.
        """
        rows = np.arange(stretch.context.n)
        last = np.maximum.accumulate(np.where(turns(stretch), rows, 0))
        return np.asarray(runs_out(stretch) * self._at_phases_rad_s(stretch)[last])

    def _at_phases_rad_s(self, stretch: Stretch) -> Array:
        """Return σ(φ) at the phase that each row is set to, shape (N,)."""
        sigma = np.interp(stretch.context.phase_deg, self.phase_deg, self.sigma_rad_s)
        return np.asarray(sigma, dtype=np.float64)

    def to_mapping(self) -> dict[str, Any]:
        """Return what the model file keeps."""
        return {
            "phase_deg": self.phase_deg.tolist(),
            "sigma_rad_s": self.sigma_rad_s.tolist(),
            "ar": self.ar.tolist(),
            "innovation": self.innovation,
            "step_rad_s": self.step_rad_s.tolist(),
            "step_spread_rad_s": self.step_spread_rad_s.tolist(),
            "start_rad_s": self.start_rad_s.tolist(),
            "same_again": self.same_again.tolist(),
            "running_out": self.running_out,
        }


def noise_from_mapping(content: dict[str, Any]) -> Noise:
    """Return the noise that a model file keeps.

    Parameters
    ----------
    content
        As `Noise.to_mapping` returns it.

    Raises
    ------
    ValueError
        What is there is of another shape, or no noise.
    """
    numbers = ("innovation", "running_out")
    arrays = {
        f.name: _table(f.name, content[f.name]) for f in fields(Noise) if f.name not in numbers
    }
    running_out = float(content.get("running_out", 0.0))
    noise = Noise(innovation=float(content["innovation"]), running_out=running_out, **arrays)
    sizes = noise.step_rad_s.shape
    shapes = {
        "sigma_rad_s": (max(noise.phase_deg.size, 1),),
        "step_spread_rad_s": (LAGS, KINDS, *sizes[2:]),
        "step_rad_s": (LAGS, KINDS, max(sizes[-1:], default=1) or 1),
        "start_rad_s": (len(STARTS),),
        "same_again": (LAGS,),
    }
    for name, shape in shapes.items():
        if getattr(noise, name).shape != shape:
            raise ValueError(f"noise.{name} has not the shape {shape}")
    for name in ("phase_deg", "step_rad_s"):
        if np.any(np.diff(getattr(noise, name)) < 0.0):
            raise ValueError(f"noise.{name} does not rise")
    if np.max(np.abs(poles(-noise.ar)), initial=0.0) >= 1.0:
        raise ValueError("noise.ar is no noise: it grows without end")
    return noise


def _table(name: str, rows: Any) -> Array:
    """Return lists of numbers as an array."""
    try:
        return np.array(rows, dtype=np.float64)
    except ValueError:
        raise ValueError(f"noise.{name} has rows of different lengths") from None
