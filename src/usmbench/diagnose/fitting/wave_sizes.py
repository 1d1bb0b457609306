"""Amplitude and angle of what was fitted as a cosine and a sine, with 95 % intervals."""

import math

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.evidence import Estimate
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.intervals import EDGE_95
from usmbench.diagnose.fitting.joint import Joint
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.effects.parameter import Wave

Array = NDArray[np.float64]


def wave_sizes(problem: Problem, fit: Fit, spread: float) -> list[tuple[Estimate, ...]]:
    """Return the amplitude and the angle of each wave that the effects declare, by effect.

    The two amplitudes of a cosine and a sine hang together where the shaft turns little; their
    covariance says how far along the wave and across it they may lie.

    Parameters
    ----------
    problem
        The problem.
    fit
        A refined fit.
    spread
        Standard deviation of the whitened noise, at least 1.
    """
    if not any(applied.effect.waves for applied in fit.effects):
        return [() for _ in fit.effects]
    joint = Joint(problem, fit.effects)
    jacobian = joint.jacobian(joint.start)
    covariance = np.asarray(np.linalg.pinv(jacobian.T @ jacobian), dtype=np.float64)
    reach = EDGE_95 * spread**2 * covariance
    found, at = [], 0
    for applied in fit.effects:
        names = [p.name for p in applied.effect.parameters]
        own: list[Estimate] = []
        for wave in applied.effect.waves:
            pair = [at + names.index(name) for name in (wave.cosine, wave.sine)]
            unit = applied.effect.parameters[pair[0] - at].unit
            own += polar(wave, unit, joint.start[pair], reach[np.ix_(pair, pair)])
        found.append(tuple(own))
        at += len(names)
    return found


def polar(wave: Wave, unit: str, pair: Array, reach: Array) -> tuple[Estimate, Estimate]:
    """Return the amplitude and the angle of one wave.

    Parameters
    ----------
    wave
        The wave.
    unit
        Unit of its amplitudes.
    pair
        Amplitudes of the cosine and the sine, shape (2,).
    reach
        Their covariance times the square of the 95 % quantile, shape (2, 2).
    """
    size, angle_rad = float(np.hypot(*pair)), math.atan2(pair[1], pair[0])
    along = np.array([math.cos(angle_rad), math.sin(angle_rad)])
    across = np.array([-along[1], along[0]])
    half, half_across = (math.sqrt(max(float(v @ reach @ v), 0.0)) for v in (along, across))
    # A wave that may be none has any angle.
    turn = math.asin(half_across / size) if half_across < size and half < size else math.pi
    low, angle, high = (math.degrees(angle_rad + part) for part in (-turn, 0.0, turn))
    return (
        Estimate(wave.name, size, max(size - half, 0.0), size + half, unit, wave.what),
        Estimate(f"{wave.name}_at_deg", angle, low, high, "deg", "angle at which it is largest"),
    )
