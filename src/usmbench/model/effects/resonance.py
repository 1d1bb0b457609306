"""The motor on its resonance curve: what the model's own frequencies tell of another vibration."""

from collections.abc import Sequence

import numpy as np

from usmbench.errors import InputError
from usmbench.model.effects.base import Array, Effect
from usmbench.model.effects.context import Context

_KNOWN = "the model knows the resonance curve, along which another form goes"
_UNKNOWN = "the model knows one drive frequency only; identify it on runs at several, near each"
_STEEP = 5.0  # relative change of speed over that of frequency; below, the pair spans the top


class AlongResonance(Effect):
    """An effect that moves the motor along the resonance curve that its model knows."""

    stage = "settled"

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why these runs cannot show the cause, or None where they can.

        Parameters
        ----------
        contexts
            All stretches.
        """
        return None if knows_resonance(contexts) else _UNKNOWN


class WithoutResonance(Effect):
    """An effect on the vibration where the model does not know its resonance curve."""

    stage = "settled"

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why these runs cannot show the cause, or None where they can.

        Parameters
        ----------
        contexts
            All stretches.
        """
        return _KNOWN if knows_resonance(contexts) else None


def detuned(signal: Array, context: Context, relative: Array | float) -> Array:
    """Return the settled speed with the drive elsewhere on the resonance curve, shape (N,).

    Parameters
    ----------
    signal
        Settled speed in rad/s, shape (N,).
    context
        The stretch.
    relative
        Frequency of the drive against the resonance, less what the model takes it for, as a share,
        shape (N,) or scalar.
    """
    return _moved(signal, context, relative * _detuning_rad_s(context, context.phase_deg))


def vibrating_less(signal: Array, context: Context, speed_lost: Array | float) -> Array:
    """Return the settled speed with another vibration at the same frequency, shape (N,).

    The highest speed is that of the crests. How the others follow it, friction included, shows
    beside the frequency on the model's curve.

    Parameters
    ----------
    signal
        Settled speed in rad/s, shape (N,).
    context
        The stretch.
    speed_lost
        Share of the highest speed that is lost, shape (N,) or scalar.
    """
    top_rad_s, change_rad_s = _at_top(context)
    slope_rad_s = _detuning_rad_s(context, context.phase_deg)
    # Without drive there is neither a speed nor a slope.
    follows = np.divide(
        slope_rad_s, change_rad_s, out=np.zeros(context.n), where=change_rad_s != 0.0
    )
    return _moved(signal, context, -speed_lost * top_rad_s * follows)


def knows_resonance(contexts: Sequence[Context]) -> bool:
    """Return whether the model says how the speed changes along the resonance curve.

    Parameters
    ----------
    contexts
        All stretches of the runs under diagnosis.
    """
    return all(context.detuning_rad_s is not None and _steep(context) for context in contexts)


def _steep(context: Context) -> bool:
    top_rad_s, change_rad_s = _at_top(context)
    return bool(np.all(np.abs(change_rad_s) > _STEEP * np.abs(top_rad_s)))


def _at_top(context: Context) -> tuple[Array, Array]:
    """Highest speed at each row's operating point, and its change with the frequency."""
    phase_deg = context.phase_deg
    top_deg = phase_deg[np.argmax(np.abs(context.settled_rad_s(phase_deg)))]
    everywhere = np.full(context.n, top_deg)
    return context.settled_rad_s(everywhere), _detuning_rad_s(context, everywhere)


def _detuning_rad_s(context: Context, phase_deg: Array) -> Array:
    if context.detuning_rad_s is None:
        raise InputError(f"an effect moves the motor along its resonance curve, but {_UNKNOWN}")
    return context.detuning_rad_s(phase_deg)


def _moved(signal: Array, context: Context, change_rad_s: Array) -> Array:
    """Change a speed; one that friction holds at rest does not start the other way."""
    way = np.where(signal == 0.0, np.sign(context.phase_deg), np.sign(signal))
    moved = signal + change_rad_s
    return np.where(moved * way > 0.0, moved, 0.0)
