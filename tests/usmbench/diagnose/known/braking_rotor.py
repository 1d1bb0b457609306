"""A rotor that brakes faster than it runs up, turned in many small steps."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WINDOW_S, STEPS = 0.01, 250  # steps a window


def turned_rad_s(settled_rad_s: Array, up_s: float, down_s: float, delay_s: float) -> Array:
    """Return mean speeds of windows, by many small steps of a rotor."""
    step_s = WINDOW_S / STEPS
    late = np.full(round(delay_s / step_s), settled_rad_s[0])
    commanded = np.append(late, np.repeat(settled_rad_s, STEPS))[: STEPS * settled_rad_s.size]
    follows_up, follows_down = (-np.expm1(-step_s / tau_s) for tau_s in (up_s, down_s))
    speed, course = float(commanded[0]), []
    for to in commanded.tolist():
        brakes = abs(to) < abs(speed) or to * speed < 0.0
        before = speed
        speed += (follows_down if brakes else follows_up) * (to - speed)
        course.append(0.5 * (before + speed))
    means: Array = np.reshape(course, (-1, STEPS)).mean(axis=1)
    return means
