"""95 % intervals: how far the estimates would move with other noise of the same kind."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.special import ndtri

from usmbench.identify.dynamics import Parametrised
from usmbench.identify.knots import dead_zone_deg, standing_edges_deg
from usmbench.identify.linearised import Linearisation
from usmbench.identify.noise import coloured_back, fit_noise
from usmbench.identify.polish import Polished
from usmbench.identify.triangle import full_rank, triangle
from usmbench.model.bernstein import bernstein_basis
from usmbench.model.effects.first_order import net_delay_s
from usmbench.model.hammerstein import StaticCurve
from usmbench.model.inverse_map import bezier_abscissa
from usmbench.model.linear import time_constant_s

Array = NDArray[np.float64]

_TWO_SIDED = float(ndtri(0.975))
_BAND_POINTS = 91
_EDGE_GRID = 401
_NUDGE = 1e-5
_LONGEST = 1e4  # windows: what the data say of a time constant ends there


@dataclass(frozen=True, slots=True)
class Covariance:
    """Square roots C of covariances C Cᵀ.

    Parameters
    ----------
    dynamics
        Of the family's parameters, shape (m, k).
    delta
        Of each operating point's ordinates, shape (d + 1, k).
    noise_coefficients
        Autoregressive colour of the noise that was assumed.
    """

    dynamics: Array
    delta: tuple[Array, ...]
    noise_coefficients: Array


@dataclass(frozen=True, slots=True)
class Estimate:
    """What was found, and the problem about it.

    Parameters
    ----------
    family
        Family of the dynamics.
    found
        Dynamics and curves.
    linearised
        Stretches of the record near the estimate.
    share
        Rows of these stretches over the rows that the estimate rests on.
    """

    family: Parametrised
    found: Polished
    linearised: Linearisation
    share: float


def covariance(estimate: Estimate, priors: Sequence[Array]) -> Covariance:
    """Return the covariance of the estimates under the residuals' own colour.

    With the regressors J, the mean slope κ of the robust influence ψ, and ψ of the residuals an
    autoregressive process with covariance Γ, it is the sandwich ``B Jᵀ Γ J B`` with
    ``B = (κ JᵀJ + prior)⁻¹`` (Huber and Ronchetti 2009, section 7.6). Everything is formed from
    triangular factors; the curves of the operating points touch only through the dynamics.

    Parameters
    ----------
    estimate
        The estimate.
    priors
        Rows of prior knowledge of each operating point's curve.
    """
    linearised, n = estimate.linearised, estimate.linearised.n
    colour, white = fit_noise([piece.influence for piece in linearised.pieces])
    parts = []
    for point, (prior, rows) in enumerate(zip(priors, linearised.factors, strict=True)):
        known = np.hstack([prior, np.zeros((prior.shape[0], rows.shape[1] - prior.shape[1]))])
        coloured = rows
        if colour.size:
            mine = [piece.regressors for piece in linearised.at(point)]
            coloured = triangle(*(coloured_back(colour, own) for own in mine))
        # The prior counts as noise too: so the band covers the bias it brings (Nychka 1988).
        meat = white * triangle(coloured, known).T
        bread = full_rank(np.sqrt(linearised.slope) * rows, known)
        parts.append(_Part(bread, meat, prior.shape[1]))
    size = parts[0].coupling.shape[1] + sum(part.n for part in parts)
    inflation = np.sqrt(estimate.share * n / max(n - size, 1))
    dynamics = _dynamics_root(parts) * inflation
    deltas, first = [], 0
    for part in parts:
        own = np.zeros((part.n, dynamics.shape[1]))
        last = first + part.meat.shape[1]
        own[:, first:last] = inflation * part.solved_twice(part.meat[: part.n])
        deltas.append(own - solve_triangular(part.corner, part.coupling @ dynamics))
        first = last
    return Covariance(dynamics, tuple(deltas), colour)


@dataclass(frozen=True, slots=True)
class _Part:
    """Triangular factors of one operating point: curve first, dynamics after it."""

    bread: Array
    meat: Array
    n: int

    @property
    def corner(self) -> Array:
        return self.bread[: self.n, : self.n]

    @property
    def coupling(self) -> Array:
        return self.bread[: self.n, self.n :]

    def solved_twice(self, columns: Array) -> Array:
        """Return (FᵀF)⁻¹ columns from the factor of F."""
        half = solve_triangular(self.corner, columns, trans="T")
        return np.asarray(solve_triangular(self.corner, half), dtype=np.float64)


def _dynamics_root(parts: Sequence[_Part]) -> Array:
    """Square root of the dynamics' covariance, with one block of columns an operating point."""
    pushed = []
    for part in parts:
        carried = solve_triangular(part.corner, part.meat[: part.n], trans="T")
        pushed.append(part.meat[part.n :] - part.coupling.T @ carried)
    columns = np.asarray(np.hstack(pushed), dtype=np.float64)
    if columns.shape[0] == 0:
        return columns
    corner = triangle(*(part.bread[part.n :, part.n :] for part in parts))
    half = solve_triangular(corner, columns, trans="T")
    return np.asarray(solve_triangular(corner, half), dtype=np.float64)


def dynamics_intervals(
    estimate: Estimate, spread: Covariance, window_s: float | None
) -> dict[str, Any]:
    """Return 95 % intervals of a, b, time constant, dead time and torque limit.

    Parameters
    ----------
    estimate
        The estimate.
    spread
        Its covariance.
    window_s
        Time step.

    Returns
    -------
    dict
        ``a`` and ``b``: a [low, high] an element; ``tau_s``, ``dead_time_s`` and
        ``slip_limit_rad_s``: [low, high] or None.
    """
    fit, family = estimate.found, estimate.family

    def outcome(parameters: Array) -> Array:
        linear = family.dynamics(parameters).linear_part(window_s)
        tau_s, dead_s = time_constant_s(linear), net_delay_s(linear)
        slip_rad_s = linear.slip_limit_rad_s
        ends = [
            np.nan if tau_s is None else np.log(tau_s),
            np.nan if dead_s is None else dead_s,
            np.nan if slip_rad_s is None else np.log(slip_rad_s),
        ]
        return np.concatenate([linear.a, linear.b, np.array(ends)])

    centre = outcome(fit.parameters)
    slopes = np.empty((centre.size, fit.parameters.size))
    for k in range(fit.parameters.size):
        nudge = _NUDGE * np.eye(fit.parameters.size)[k]
        up, down = (_within(family, fit, side * nudge) for side in (1.0, -1.0))
        slopes[:, k] = (outcome(up) - outcome(down)) / (up[k] - down[k])
    reach = _TWO_SIDED * np.linalg.norm(slopes @ spread.dynamics, axis=1)
    na = fit.dynamics.a.size
    low, high = centre - reach, centre + reach
    pairs = np.column_stack([low, high]).tolist()
    longest = np.log(_LONGEST * (window_s or 1.0))
    tau, dead, slip = np.exp(np.minimum(pairs[-3], longest)).tolist(), pairs[-2], pairs[-1]
    return {
        "a": pairs[:na],
        "b": pairs[na:-3],
        "tau_s": None if np.isnan(tau[0]) else tau,
        "dead_time_s": None if np.isnan(dead[0]) else np.maximum(dead, 0.0).tolist(),
        "slip_limit_rad_s": None if np.isnan(slip[0]) else np.exp(slip).tolist(),
    }


def _within(family: Parametrised, fit: Polished, nudge: Array) -> Array:
    """Return the fit's parameters moved, but not to where the dead time has other whole windows.

    The coefficients b are those after so many windows: beyond, they are others.
    """
    moved = family.moved(fit.parameters, nudge)
    whole = family.dynamics(moved).dead_time_windows
    return moved if whole == fit.dynamics.dead_time_windows else fit.parameters


def curve_intervals(curve: StaticCurve, root: Array) -> dict[str, Any]:
    """Return 95 % intervals of a curve, its highest speed and its dead zone.

    Parameters
    ----------
    curve
        The curve.
    root
        Square root of its ordinates' covariance, shape (d + 1, k).

    Returns
    -------
    dict
        ``band`` with ``phase_deg``, ``low_rad_s``, ``high_rad_s`` (at each phase by itself),
        ``gain_rad_s`` (highest speed) and ``dead_zone_low_deg``, ``dead_zone_high_deg`` as
        [low, high] or None.
    """
    grid_deg = np.linspace(curve.knots_deg[0], curve.knots_deg[-1], _BAND_POINTS)
    basis = bernstein_basis(bezier_abscissa(grid_deg, curve.knots_deg), curve.degree)
    speed = basis @ curve.delta
    reach = _TWO_SIDED * np.linalg.norm(basis @ root, axis=1)
    top = int(np.argmax(np.abs(speed)))
    gain = abs(float(speed[top]))
    low, high = _edge_intervals(curve, root)
    return {
        "band": {
            "phase_deg": grid_deg.tolist(),
            "low_rad_s": (speed - reach).tolist(),
            "high_rad_s": (speed + reach).tolist(),
        },
        "gain_rad_s": [gain - float(reach[top]), gain + float(reach[top])],
        "dead_zone_low_deg": low,
        "dead_zone_high_deg": high,
    }


def _edge_intervals(
    curve: StaticCurve, root: Array
) -> tuple[list[float] | None, list[float] | None]:
    """Intervals of the dead zone's edges, from curves a standard deviation off along each axis."""
    axes = triangle(root.T)
    grid_deg = np.linspace(curve.knots_deg[0], curve.knots_deg[-1], _EDGE_GRID)
    basis = bernstein_basis(bezier_abscissa(grid_deg, curve.knots_deg), curve.degree)
    up, down = (
        standing_edges_deg(grid_deg, (curve.delta + side * axes) @ basis.T) for side in (1.0, -1.0)
    )
    reach = 0.5 * _TWO_SIDED * np.linalg.norm(up - down, axis=0)
    low, high = (
        None if edge_deg is None or np.isnan(wide) else [edge_deg - wide, edge_deg + wide]
        for edge_deg, wide in zip(dead_zone_deg(curve), reach.tolist(), strict=True)
    )
    return low, high
