"""Runs of one disc whose angles begin anywhere, as those of an encoder without an index do.

A ripple once a revolution has another phase in each of them. Where several show one plainly, and by
about as much, their angles are shifted until it has one phase.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.stretches import Stretch

Array = NDArray[np.float64]

_PLAIN = 300.0  # chi-squared with two: neither chance nor what else the model misses
_ALIKE = 1.5  # times the strongest one's ripple, or less by as much
_SETTLED, _TURNING = 2, 0.1  # windows after a step; of the highest speed
_BLOCKS = 20  # in which what else the model misses is taken to be off the same way


@dataclass(frozen=True, slots=True)
class _Ripple:
    """A run's ripple once a revolution, A cos(α − ψ) of the speed."""

    share: float
    phase_rad: float
    statistic: float


def at_one_angle(stretches: Sequence[Stretch]) -> tuple[list[Stretch], list[str]]:
    """Shift the angles of runs until a ripple that several show has one phase.

    Parameters
    ----------
    stretches
        The runs.

    Returns
    -------
    stretches, warnings
        In the same order, and what the user ought to know.
    """
    found = {r: _ripple([s for s in stretches if s.run == r]) for r in {s.run for s in stretches}}
    plain = {r: ripple for r, ripple in found.items() if ripple.statistic > _PLAIN}
    if len(plain) < 2:
        return list(stretches), []
    first = max(plain, key=lambda r: plain[r].statistic)
    alike = {
        r: ripple
        for r, ripple in plain.items()
        if 1.0 / _ALIKE < ripple.share / plain[first].share < _ALIKE
    }
    turned = {r: plain[first].phase_rad - ripple.phase_rad for r, ripple in alike.items()}
    named = next(s.name for s in stretches if s.run == first)
    warning = (
        "the shaft's angle begins anew in each run: those that show a ripple once a revolution are "
        f"shifted to the angles of {named}, and its phase holds for that run"
    )
    return [_shifted(s, turned.get(s.run, 0.0)) for s in stretches], [warning] * (len(alike) > 1)


def _shifted(stretch: Stretch, by_rad: float) -> Stretch:
    """Return a stretch whose shaft is farther on."""
    if stretch.context.angle_rad is None or by_rad == 0.0:
        return stretch
    context = replace(stretch.context, angle_rad=stretch.context.angle_rad + by_rad)
    return replace(stretch, context=context)


def _ripple(stretches: Sequence[Stretch]) -> _Ripple:
    """Fit the ripple of one run by least squares, beside a gain and a slip.

    Its covariance is the sandwich over blocks (White 1980, doi:10.2307/1912934).
    """
    columns, residual = [], []
    for s in stretches:
        speed = s.simulated_rad_s
        turns = np.abs(speed) > _TURNING * float(np.max(np.abs(speed), initial=0.0))
        rows = s.use & turns & ((s.lag >= _SETTLED) | (s.step_rad_s == 0.0))
        angle = s.context.angle_rad
        if angle is None or not rows.any():
            continue
        waves = (speed * np.cos(angle), speed * np.sin(angle), speed, np.sign(speed))
        columns.append(np.column_stack(waves)[rows])
        residual.append(s.residual_rad_s[rows])
    if sum(map(len, residual)) <= _BLOCKS:
        return _Ripple(0.0, 0.0, 0.0)
    matrix, error = np.vstack(columns), np.concatenate(residual)
    normal = np.linalg.pinv(matrix.T @ matrix)
    sizes = normal @ (matrix.T @ error)
    left = matrix * (error - matrix @ sizes)[:, None]
    scores = np.array([np.sum(block, axis=0) for block in np.array_split(left, _BLOCKS)])
    covariance = (normal @ (scores.T @ scores) @ normal)[:2, :2]
    wave = sizes[:2]
    statistic = float(wave @ np.linalg.pinv(covariance) @ wave)
    return _Ripple(float(np.hypot(*wave)), float(np.arctan2(wave[1], wave[0])), statistic)
