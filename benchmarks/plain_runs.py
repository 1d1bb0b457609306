"""Plans, noise and files of plain runs."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]

KINDS = ("staircase", "triangle", "multisine", "random", "sine", "levels")


def plan_deg(kind: str, n: int, top_deg: float, rng: np.random.Generator) -> Array:
    """Return the phases of a plan, shape (n,).

    Parameters
    ----------
    kind
        One of `KINDS`.
    n
        Number of windows.
    top_deg
        Largest phase.
    rng
        Where chance comes from.
    """
    if kind == "staircase":
        levels_deg = np.linspace(-top_deg, top_deg, 13 if n < 600 else 25)
        once = np.r_[levels_deg, levels_deg[::-1]]
        return np.resize(np.repeat(once, n // once.size // max(1, n // 800)), n)
    if kind == "triangle":
        along = np.arange(n) * max(2, n // 250) / n
        return np.round(top_deg * (1.0 - 4.0 * np.abs(along % 1.0 - 0.5)), 1)
    if kind == "sine":
        along = np.arange(n) * max(2, n // 250) / n
        return np.round(top_deg * np.sin(2.0 * np.pi * along), 1)
    if kind == "levels":
        levels_deg = np.linspace(-top_deg, top_deg, 9)
        return np.repeat(rng.choice(levels_deg, -(-n // 8)), 8)[:n]
    if kind == "random":
        return np.repeat(np.round(rng.uniform(-top_deg, top_deg, -(-n // 6)), 1), 6)[:n]
    tones = np.arange(1, max(3, n // 16))
    turned = 4.0 * np.pi / n * np.outer(np.arange(n), tones)
    waves = np.cos(turned + rng.uniform(0.0, 2.0 * np.pi, tones.size)) @ tones**-0.5
    return np.asarray(np.round(top_deg * waves / np.max(np.abs(waves)), 1))


def noise_rad_s(n: int, deviation_rad_s: float, colour: float, rng: np.random.Generator) -> Array:
    """Return autoregressive noise, shape (n,).

    Parameters
    ----------
    n
        Windows.
    deviation_rad_s
        Standard deviation.
    colour
        Correlation from window to window.
    rng
        Where chance comes from.
    """
    white = np.sqrt(1.0 - colour**2) * rng.standard_normal(n + 100)
    return np.asarray(deviation_rad_s * lfilter([1.0], [1.0, -colour], white)[100:])


def write_csv(
    path: Path, phase_deg: Array, measured_rad_s: Array, angle_rad: Array, window_s: float
) -> None:
    """Write a run as a bare CSV file.

    Parameters
    ----------
    path
        The file.
    phase_deg, measured_rad_s, angle_rad
        Phase, speed and angle, shape (N,) each.
    window_s
        Duration of a window.
    """
    t_s = window_s * np.arange(1.0, phase_deg.size + 1.0)
    table = np.column_stack((t_s, phase_deg, measured_rad_s, angle_rad))
    head = "t_s,phase_deg,speed_rad_s,angle_rad"
    np.savetxt(path, table, delimiter=",", header=head, comments="", fmt="%.9g")
