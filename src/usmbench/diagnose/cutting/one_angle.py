"""Runs of one disc whose angles begin anywhere, as those of an encoder without an index do.

A ripple once a revolution has another phase in each of them. Where several show one plainly, and by
about as much, their angles are shifted until it has one phase; where a model knows the ripple,
until it has the model's.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.model.applied import Applied
from usmbench.model.extended import extended_run

Array = NDArray[np.float64]

_PLAIN = 300.0  # chi-squared with two: neither chance nor what else the model misses
_LIKEWISE = 30.0  # of another run that ripples by about as much: one in a thousand by chance
_SAME = 4.0  # standard deviations of a phase
_ALIKE = 1.5  # times the strongest one's ripple, or less by as much
_SETTLED, _TURNING = 2, 0.1  # windows after a step; of the highest speed
_GENTLE = 0.1  # of the highest speed, a window: a command that glides
_TRIED = 16  # angles of a revolution
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
    first = max(found, key=lambda r: found[r].statistic)
    share, phase_rad = found[first].share, found[first].phase_rad
    turned = {
        r: phase_rad - ripple.phase_rad
        for r, ripple in found.items()
        if ripple.statistic > _LIKEWISE and share / _ALIKE < ripple.share < share * _ALIKE
    }
    plain = found[first].statistic > _PLAIN
    apart = (found[r].statistic * np.angle(np.exp(1j * turned[r])) ** 2 for r in turned)
    if not (plain and any(by > _SAME**2 for by in apart)):
        return list(stretches), []
    named = next(s.name for s in stretches if s.run == first)
    warning = (
        "the shaft's angle begins anew in each run: those that show a ripple once a revolution are "
        f"shifted to the angles of {named}, and its phase holds for that run"
    )
    return [_shifted(s, turned.get(s.run, 0.0)) for s in stretches], [warning]


def at_models_angle(
    stretches: Sequence[Stretch], own: Sequence[Applied]
) -> tuple[list[Stretch], list[str]]:
    """Shift the angles of runs until a ripple that a model knows has the model's phase.

    Parameters
    ----------
    stretches
        The runs.
    own
        All effects with which they were simulated.

    Returns
    -------
    stretches, warnings
        In the same order, and what the user ought to know.
    """
    placed, shifted = [], []
    for run in dict.fromkeys(s.run for s in stretches):
        parts = [s for s in stretches if s.run == run]
        by_rad = _best_angle_rad(parts, own)
        placed += [_simulated_again(s, by_rad, own) for s in parts]
        shifted += [parts[0].name] if by_rad else []
    return placed, [
        f"{name}: the shaft's angle begins elsewhere than in the model's run; it is shifted until "
        "the ripple once a revolution is the model's"
        for name in shifted
    ]


def _best_angle_rad(stretches: Sequence[Stretch], own: Sequence[Applied]) -> float:
    """Return by how much farther on a run's shaft is than it says; 0 unless that is plain."""

    def square(by_rad: float) -> float:
        again = (_simulated_again(s, by_rad, own) for s in stretches)
        return sum(float(np.sum(s.residual_rad_s[s.use] ** 2)) for s in again)

    step_rad = 2.0 * np.pi / _TRIED
    tried = {k * step_rad: square(k * step_rad) for k in range(_TRIED)}
    if len(set(tried.values())) == 1:
        return 0.0  # no effect depends on it
    near_rad = min(tried, key=lambda by_rad: tried[by_rad])
    best = minimize_scalar(square, bounds=(near_rad - step_rad, near_rad + step_rad))
    n = sum(int(np.count_nonzero(s.use)) for s in stretches)
    return float(best.x) if tried[0.0] - best.fun > _PLAIN * best.fun / max(n, 1) else 0.0


def _simulated_again(stretch: Stretch, by_rad: float, own: Sequence[Applied]) -> Stretch:
    """Return a stretch whose shaft is farther on, simulated with effects that may depend on it."""
    if by_rad == 0.0:
        return stretch
    shifted = _shifted(stretch, by_rad)
    return replace(shifted, simulated_rad_s=extended_run(own, shifted.context).speed_rad_s)


def _shifted(stretch: Stretch, by_rad: float) -> Stretch:
    """Return a stretch whose shaft is farther on."""
    if stretch.context.angle_rad is None or by_rad == 0.0:
        return stretch
    context = replace(stretch.context, angle_rad=stretch.context.angle_rad + by_rad)
    return replace(stretch, context=context)


def _ripple(stretches: Sequence[Stretch]) -> _Ripple:
    """Fit the ripple of one run by least squares, beside a gain and a slip each way.

    Its covariance is the sandwich over blocks (White 1980, doi:10.2307/1912934): what else is
    smooth and off, such as a direction that is faster, would hide the ripple in it.
    """
    columns, residual = [], []
    for s in stretches:
        speed = s.simulated_rad_s
        top_rad_s = float(np.max(np.abs(speed), initial=0.0))
        gently = (s.lag >= _SETTLED) | (np.abs(s.step_rad_s) < _GENTLE * top_rad_s)
        rows = s.use & (np.abs(speed) > _TURNING * top_rad_s) & gently
        angle = s.context.angle_rad
        if angle is None or not rows.any():
            continue
        usual = (speed, np.abs(speed), np.sign(speed), np.ones(speed.size))
        waves = (speed * np.cos(angle), speed * np.sin(angle), *usual)
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
