"""The paper's inverse de Casteljau iteration, eq. (8) to (13), for all samples at once."""

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.model.inverse_map import check_knots

Array = NDArray[np.float64]

LEARNING_RATE = 0.01  # γ of eq. (12), as in Section V
_MAX_ITERATIONS = 20_000


def inverse_de_casteljau(
    phase_deg: Array,
    knots_deg: Array,
    rng: np.random.Generator,
    *,
    tolerance_deg: float = 1e-10,
) -> tuple[Array, int]:
    """Map phases to abscissas of the Bézier curve by error feedback.

    Parameters
    ----------
    phase_deg
        Phases φ within the knots, shape (N,).
    knots_deg
        Knots Φ, strictly rising, shape (d + 1,).
    rng
        Draws the start of every iteration in (0, 1).
    tolerance_deg
        ε: the iteration of a sample stops once ``|φ − φ̂(x)|`` is within it. The paper tests
        φ̃, which belongs to the next x, and returns this one.

    Returns
    -------
    x
        Abscissas, shape (N,).
    iterations
        Rounds the slowest sample took.

    Raises
    ------
    InputError
        Knots that do not rise, or an iteration that does not come to rest.
    """
    check_knots(knots_deg)
    x = rng.uniform(0.0, 1.0, phase_deg.size)
    moving = np.arange(phase_deg.size)
    for iteration in range(_MAX_ITERATIONS):
        left_deg, right_deg = _last_chord(x[moving], knots_deg)
        reached_deg = (1.0 - x[moving]) * left_deg + x[moving] * right_deg  # (11)
        error_deg = phase_deg[moving] - reached_deg
        target_deg = reached_deg + LEARNING_RATE * error_deg  # (12)
        open_ = np.abs(error_deg) > tolerance_deg
        if not np.any(open_):
            return x, iteration
        moving = moving[open_]
        chord_deg = right_deg[open_] - left_deg[open_]
        x[moving] = (target_deg[open_] - left_deg[open_]) / chord_deg  # (13)
    raise InputError(
        f"the inverse de Casteljau iteration did not come within {tolerance_deg:g}° of "
        f"{phase_deg[moving[0]]:g}° in {_MAX_ITERATIONS} rounds; spread the knots, or use "
        "--method fast"
    )


def _last_chord(x: Array, knots_deg: Array) -> tuple[Array, Array]:
    """Both points of level d − 1 of the de Casteljau scheme, eq. (10)."""
    level = np.repeat(knots_deg[:, None], x.size, axis=1)
    while level.shape[0] > 2:
        level = (1.0 - x) * level[:-1] + x * level[1:]
    return level[0], level[1]
