"""The simulation with effects in it, stage by stage."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from usmbench.model.applied import Applied
from usmbench.model.effects.base import DynamicsEffect, Stage
from usmbench.model.effects.context import Context, middle_rad
from usmbench.model.hammerstein import LinearPart
from usmbench.model.linear import fitted_start_rad_s, free_run, free_runs

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ExtendedRun:
    """What the stages give.

    Parameters
    ----------
    settled_rad_s
        Settled speed, shape (N,).
    speed_rad_s
        Speed that is reported, shape (N,).
    """

    settled_rad_s: Array
    speed_rad_s: Array


def extended_run(
    effects: Sequence[Applied], context: Context, measured_rad_s: Array | None = None
) -> ExtendedRun:
    """Run the simulation free over an unbroken stretch.

    Parameters
    ----------
    effects
        The effects; those of one stage act in the order given, the early ones first.
    context
        The stretch.
    measured_rad_s
        Measured speed, shape (N,), from whose first windows the start is taken; None starts
        settled.
    """
    shaft = shaft_run(effects, context, measured_rad_s)
    return ExtendedRun(shaft.settled_rad_s, counted(effects, shaft.speed_rad_s, context))


def shaft_run(
    effects: Sequence[Applied], context: Context, measured_rad_s: Array | None = None
) -> ExtendedRun:
    """Run the simulation free up to the speed of the motor's shaft.

    Parameters
    ----------
    effects, context, measured_rad_s
        As in `extended_run`.
    """
    settled_rad_s = _driven(effects, context)
    linear = linear_part(effects, context)
    start_rad_s = None
    if measured_rad_s is not None:
        start_rad_s = fitted_start_rad_s(linear, settled_rad_s, measured_rad_s)
    return ExtendedRun(settled_rad_s, free_run(linear, settled_rad_s, start_rad_s))


def shaft_speeds(effects: Sequence[Applied], contexts: Sequence[Context]) -> list[Array]:
    """Return the speed of the motor's shaft on several stretches, as by `shaft_run` on each.

    Parameters
    ----------
    effects
        The effects.
    contexts
        The stretches.

    Returns
    -------
    list of Array
        In rad/s, shape (N,) each.
    """
    settled_rad_s = [_driven(effects, context) for context in contexts]
    linears = [linear_part(effects, context) for context in contexts]
    # Many short runs take many times as long as one.
    if all(linear is linears[0] for linear in linears):
        return free_runs(linears[0], settled_rad_s)
    return [free_run(*pair) for pair in zip(linears, settled_rad_s, strict=True)]


def _driven(effects: Sequence[Applied], context: Context) -> Array:
    """Return the settled speed that drives the dynamics, shape (N,)."""
    phase_deg = through(effects, "command", context.phase_deg, context)
    starting, moving = context, moving_starts(effects)
    if moving:
        start_deg = through(moving, "command", context.phase_deg, context)
        starting = replace(context, phase_deg=start_deg)
    return through(effects, "settled", context.settled_rad_s(phase_deg), starting)


def moving_starts(effects: Sequence[Applied]) -> list[Applied]:
    """Return the effects that move the phases at which a rotor starts.

    Not a grid: where a start and the steps of a grid are sought one after the other, the first
    found would make up for the other.

    Parameters
    ----------
    effects
        All effects.
    """
    return [a for a in effects if a.effect.stage == "command" and not a.effect.jagged]


def counted(effects: Sequence[Applied], shaft_rad_s: Array, context: Context) -> Array:
    """Return the speed that is reported, with what sits between the motor's shaft and the report.

    Parameters
    ----------
    effects
        All effects.
    shaft_rad_s
        Speed of the shaft, shape (N,).
    context
        The stretch.
    """
    motion_rad_s = through(effects, "motion", shaft_rad_s, context)
    turned = at_shaft_angle(effects, motion_rad_s, context)
    return through(effects, "counter", motion_rad_s, turned)


def at_shaft_angle(effects: Sequence[Applied], motion_rad_s: Array, context: Context) -> Context:
    """Return a stretch with the angle by the counter made that of the shaft again.

    A counter that loses counts by chance is behind by all that it has lost since the stretch began.

    Parameters
    ----------
    effects
        All effects.
    motion_rad_s
        Speed at the counter, shape (N,).
    context
        The stretch.
    """
    chancy = [a for a in effects if a.effect.by_chance and a.effect.stage == "counter"]
    if context.angle_rad is None or not chancy:
        return context
    lost_rad_s = motion_rad_s - through(chancy, "counter", motion_rad_s, context)
    lost_rad = middle_rad(lost_rad_s, context.window_s)
    return replace(context, angle_rad=context.angle_rad + lost_rad)


def through(effects: Sequence[Applied], stage: Stage, signal: Array, context: Context) -> Array:
    """Apply the effects of one stage.

    Parameters
    ----------
    effects
        All effects.
    stage
        The stage.
    signal
        Its signal, shape (N,).
    context
        The stretch.
    """
    own = [applied for applied in effects if applied.effect.stage == stage]
    for applied in sorted(own, key=lambda applied: not applied.effect.early):
        signal = applied.effect.apply(signal, context, applied.values)
    return signal


def linear_part(effects: Sequence[Applied], context: Context) -> LinearPart:
    """Return the linear part with all effects on the dynamics.

    Parameters
    ----------
    effects
        All effects.
    context
        The stretch.
    """
    linear = context.linear
    for applied in effects:
        if isinstance(applied.effect, DynamicsEffect):
            linear = applied.effect.linear_part(linear, context, applied.values)
    return linear
