"""The paper's Levenberg-Marquardt search for b and δ, eq. (21) to (34), with its slips mended.

Every departure from the printed equations is listed in docs/explanations/identification.md
with its reason.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_TINY_STEP = 1e-14
_LARGEST_DAMPING = 1e100


@dataclass(frozen=True, slots=True)
class LmOptions:
    """Settings of the search.

    Parameters
    ----------
    alpha
        Growth factor α of the damping's factor ν: 1.01 in the paper, 2 usually.
    damping
        Start β of the damping μ.
    target_sse
        ξ: the search stops once the sum of squares is below it.
    max_iterations
        Most steps tried, accepted or not.
    stall_relative
        The search also stops where an accepted step lowers the sum of squares by less than this
        share of it: with noise in the data the paper's ξ is out of reach.
    """

    alpha: float = 1.01
    damping: float = 1.0
    target_sse: float = 0.0
    max_iterations: int = 5000
    stall_relative: float = 1e-12


@dataclass(frozen=True, slots=True)
class LmStep:
    """One line of the trace.

    Parameters
    ----------
    iteration
        Number of the step, from 1.
    sse
        Sum of squares after it (of the trial where it was refused).
    damping
        μ the step was made with.
    gain_ratio
        λ, eq. (31).
    accepted
        Whether the step was taken.
    """

    iteration: int
    sse: float
    damping: float
    gain_ratio: float
    accepted: bool


@dataclass(frozen=True, slots=True)
class LmResult:
    """Where the search ended.

    Parameters
    ----------
    b
        Numerator, of unit gain with the given denominator, shape (n_b + 1,).
    delta
        Ordinates of each operating point's curve.
    sse
        Sum of squares of ``r − r̂``.
    trace
        Every step.
    stopped
        Why: the target was met, no progress, or out of iterations.
    """

    b: Array
    delta: tuple[Array, ...]
    sse: float
    trace: tuple[LmStep, ...]
    stopped: Literal["target", "stalled", "iterations"]


@dataclass(frozen=True, slots=True)
class Lagged:
    """Regressors of one operating point.

    Parameters
    ----------
    basis
        ``B_j(x(φ(t − k)))``, shape (n_b + 1, n, d + 1).
    target_rad_s
        r(t) of eq. (20), shape (n,).
    """

    basis: Array
    target_rad_s: Array


def search(
    blocks: Sequence[Lagged], one_plus_a: float, rng: np.random.Generator, options: LmOptions
) -> LmResult:
    """Search b and δ from a random start under the constraint of unit gain.

    Parameters
    ----------
    blocks
        Regressors of each operating point.
    one_plus_a
        ``1 + Σ â_i`` from the least-squares stage, which fixes ``Σb``.
    rng
        Draws the start.
    options
        Settings.
    """
    sizes = [block.basis.shape[2] for block in blocks]
    drawn_b = rng.standard_normal((blocks[0].basis.shape[0],))
    drawn_delta = rng.standard_normal((sum(sizes),))
    b, delta = _normalised(drawn_b, drawn_delta, one_plus_a)
    error = _error(blocks, b, delta)
    sse: float = _sum_of_squares(error)
    damping: float = options.damping
    factor: float = options.alpha
    trace: list[LmStep] = []
    stopped: Literal["target", "stalled", "iterations"] = "iterations"
    while sse > options.target_sse and len(trace) < options.max_iterations:
        jacobian = _jacobian(blocks, b, delta)
        step = _damped_step(jacobian, error, damping)
        trial_b, trial_delta = _normalised(b + step[: b.size], delta + step[b.size :], one_plus_a)
        trial = _error(blocks, trial_b, trial_delta)
        trial_sse = _sum_of_squares(trial)
        predicted = float(step @ (damping * step + jacobian.T @ error))
        ratio = (sse - trial_sse) / predicted if predicted > 0.0 else -1.0
        trace.append(LmStep(len(trace) + 1, trial_sse, damping, ratio, ratio > 0.0))
        if ratio > 0.0:
            gained = sse - trial_sse
            b, delta, error, sse = trial_b, trial_delta, trial, trial_sse
            damping *= max(1.0 / 3.0, 1.0 - (2.0 * ratio - 1.0) ** 3)
            factor = options.alpha
            if gained <= options.stall_relative * sse:
                stopped = "stalled"
                break
        else:
            damping *= factor
            factor *= options.alpha
            if damping > _LARGEST_DAMPING or np.linalg.norm(step) <= _TINY_STEP:
                stopped = "stalled"
                break
    else:
        stopped = "target" if sse <= options.target_sse else "iterations"
    split = np.split(delta, np.cumsum(sizes)[:-1])
    return LmResult(b, tuple(split), sse, tuple(trace), stopped)


def _normalised(b: Array, delta: Array, one_plus_a: float) -> tuple[Array, Array]:
    """Move the gain from b into δ, eq. (29) and (30); their product stays."""
    gain = float(b.sum()) / one_plus_a
    return b / gain, delta * gain


def _sum_of_squares(error: Array) -> float:
    return float(np.dot(error, error))


def _error(blocks: Sequence[Lagged], b: Array, delta: Array) -> Array:
    """E = r − r̂, eq. (21)."""
    parts, first = [], 0
    for block in blocks:
        last = first + block.basis.shape[2]
        inputs = block.basis @ delta[first:last]
        parts.append(block.target_rad_s - b @ inputs)
        first = last
    return np.concatenate(parts)


def _jacobian(blocks: Sequence[Lagged], b: Array, delta: Array) -> Array:
    """∂r̂/∂(b, δ), eq. (26) and (27); b and δ side by side."""
    rows = sum(block.target_rad_s.size for block in blocks)
    jacobian = np.zeros((rows, b.size + delta.size))
    row, first = 0, 0
    for block in blocks:
        n, last = block.target_rad_s.size, first + block.basis.shape[2]
        jacobian[row : row + n, : b.size] = (block.basis @ delta[first:last]).T
        columns = slice(b.size + first, b.size + last)
        jacobian[row : row + n, columns] = np.tensordot(b, block.basis, axes=1)
        row, first = row + n, last
    return jacobian


def _damped_step(jacobian: Array, error: Array, damping: float) -> Array:
    """(JᵀJ + μI)⁻¹Jᵀe, eq. (28b), from the singular values of J: JᵀJ is never formed."""
    left, singular, right = np.linalg.svd(jacobian, full_matrices=False)
    step: Array = right.T @ ((singular / (singular**2 + damping)) * (left.T @ error))
    return step
