"""A user's own cause tried once on a made-up run, before anything rests on it."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import CauseError
from usmbench.model.effects.base import DynamicsEffect, Effect
from usmbench.model.effects.context import Context
from usmbench.model.effects.guarded import one_line, wrong
from usmbench.model.effects.lone_windows import LoneWindows, SporadicEffect, Weighed
from usmbench.model.effects.parameter import Parameter
from usmbench.model.hammerstein import LinearPart

Array = NDArray[np.float64]

_WINDOW_S: Final = 0.01
_DWELL: Final = 25
_N: Final = 6000
_COUNTS: Final = 2000
_NOTHING: Final = 1e-6  # of the largest in the signal


def try_out(effect: Effect) -> None:
    """Ask a cause once for everything that a diagnosis asks of it.

    Parameters
    ----------
    effect
        The cause; its attributes have been checked.

    Raises
    ------
    usmbench.errors.CauseError
        It fails, gives what is of no use, or does something where it says that it does nothing.
    """
    context = made_up_run()
    speed_rad_s = context.settled_rad_s(context.phase_deg)
    # A division by zero that it mends itself is no fault.
    with np.errstate(all="ignore"):
        try:
            effect.beneath([context], [speed_rad_s], [speed_rad_s])
            effect.habitual([context])
            effect.built_in([context])
            if effect.untestable([context]) is None:
                _try_sizes(effect, context)
        except CauseError:
            raise
        except (Exception, SystemExit) as error:  # from elsewhere than its own methods
            raise wrong(effect, f"raised {one_line(error)}") from error


def made_up_run() -> Context:
    """Return a run of a minute over all phases, of which everything is known."""
    steps = np.concatenate([np.linspace(-90.0, 90.0, 24), np.linspace(90.0, -90.0, 24)])
    phase_deg = np.resize(np.repeat(steps, _DWELL), _N)
    t_s = _WINDOW_S * np.arange(1.0, _N + 1.0)
    angle_rad = np.cumsum(_speed_rad_s(phase_deg)) * _WINDOW_S
    for column in (phase_deg, t_s, angle_rad):
        column.flags.writeable = False
    return Context(
        t_s,
        _WINDOW_S,
        phase_deg,
        _speed_rad_s,
        LinearPart(np.array([-0.05]), np.array([0.6, 0.35]), 0, _WINDOW_S),
        angle_rad,
        detuning_rad_s=lambda phase_deg: -50.0 * _speed_rad_s(phase_deg),
        count_rad_s=2.0 * np.pi / _COUNTS / _WINDOW_S,
        phase_step_deg=0.09,
    )


def _speed_rad_s(phase_deg: Array) -> Array:
    """Return the settled speed of a motor with a dead zone."""
    speed: Array = np.sign(phase_deg) * np.maximum(np.abs(phase_deg) - 5.0, 0.0) / 8.5
    return speed


def _try_sizes(effect: Effect, context: Context) -> None:
    """Apply a cause at sizes that do nothing, and at those worth finding."""
    grids = effect.grid([context])
    middle = {name: float(values[values.size // 2]) for name, values in grids.items()}
    scanned = [p for p in effect.parameters if p.scanned]
    sized = [p for p in effect.parameters if not p.scanned]
    shape = {p.name: float(np.clip(middle[p.name], p.low, p.high)) for p in scanned}
    _applied(effect, context, shape | {p.name: _worth(p) for p in sized})
    changed = _applied(effect, context, shape | {p.name: p.null for p in sized})
    if sized and changed > _NOTHING:
        raise wrong(
            effect,
            f"apply changes the signal by {changed:.1g} of its size where every parameter is null: "
            "null has to do nothing",
        )
    if isinstance(effect, SporadicEffect) and not isinstance(effect.weigh(_lone()), Weighed):
        raise wrong(effect, "weigh returns no Weighed")


def _worth(p: Parameter) -> float:
    """Return a size worth finding, within the bounds."""
    up = p.null + p.typical
    return up if up <= p.high else max(p.null - p.typical, p.low)


def _applied(effect: Effect, context: Context, values: dict[str, float]) -> float:
    """Apply a cause at its stage; return by how much it changes the signal, as a share of it."""
    if isinstance(effect, DynamicsEffect):
        effect.linear_part(context.linear, context, values)
    speed_rad_s = _speed_rad_s(context.phase_deg)
    signal = context.phase_deg if effect.stage == "command" else speed_rad_s
    off = np.max(np.abs(effect.apply(signal, context, values) - signal))
    return float(off / np.max(np.abs(signal)))


def _lone() -> LoneWindows:
    """Return windows of which every fiftieth stands alone."""
    speed_rad_s = np.linspace(-10.0, 10.0, 1000)
    alone = np.arange(1000) % 50 == 0
    off_rad_s = np.where(alone, -1.0, 0.0)
    return LoneWindows.of_one_run(speed_rad_s, off_rad_s, alone, _WINDOW_S)
