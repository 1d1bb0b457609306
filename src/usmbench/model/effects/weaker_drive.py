"""What a smaller vibration does, where no resonance curve says it: less speed, more friction."""

import numpy as np

from usmbench.model.effects.base import Array, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.parameter import Parameter
from usmbench.model.effects.resonance import WithoutResonance

# What follows its load more slowly is heat, and no supply; nothing measured sets it.
SLOWEST_SUPPLY_S = 2.0
LOST = Parameter("speed_lost", "1", 0.0, 0.0, 0.9, 0.01, what="share of the speed that is lost")
HELD_BACK = Parameter(
    "held_back_rad_s",
    "rad/s",
    0.0,
    0.0,
    30.0,
    0.05,
    what="speed that friction takes as well, most near standstill",
)


def weaker(
    signal: Array, context: Context, speed_lost: Array | float, held_back_rad_s: Array | float
) -> Array:
    """Return the settled speed of a motor that vibrates less, shape (N,).

    The crests are lower, and the friction that the vibration frees less of holds the rotor back:
    most near standstill, where the wave is a standing one, not at all at the highest speed.

    Parameters
    ----------
    signal
        Settled speed in rad/s, shape (N,).
    context
        The stretch.
    speed_lost
        Share of the speed that is lost, shape (N,) or scalar.
    held_back_rad_s
        Speed that the friction takes near standstill, shape (N,) or scalar.
    """
    held = held_back_rad_s * (1.0 - travelling(signal, context)) * np.sign(signal)
    slower = (1.0 - speed_lost) * signal - held
    return np.where(slower * signal > 0.0, slower, 0.0)


def travelling(signal: Array, context: Context) -> Array:
    """Return how far the wave travels: the square of the speed over the highest one, shape (N,).

    Parameters
    ----------
    signal
        Settled speed in rad/s, shape (N,).
    context
        The stretch.
    """
    top_rad_s = float(np.max(np.abs(context.settled_rad_s(context.phase_deg))))
    return np.minimum((signal / max(top_rad_s, 1e-12)) ** 2, 1.0)


class WeakerDrive(WithoutResonance):
    """v′ = (1 − s) v − h (1 − (v/v_top)²) sign v: the crests are lower, and friction holds more.

    At one operating point every cause that lowers the vibration looks like this.
    """

    parameters = (LOST, HELD_BACK)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return weaker(signal, context, values["speed_lost"], values["held_back_rad_s"])
