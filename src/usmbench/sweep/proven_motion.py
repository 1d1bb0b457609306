"""From which phase on the motor has to move: by the bench file, and by what the run has shown."""

from dataclasses import dataclass, replace
from math import inf

from usmbench.settings.bench import InterlockSettings

# Windows of motion at one phase that prove it: after a step the rotor still runs down for some.
WINDOWS_TO_PROVE = 5
# Beyond the phase that has moved it: friction that sticks, and a motor that warms, shift the edge.
MARGIN_DEG = 10.0


@dataclass(frozen=True, slots=True)
class ProvenMotion:
    """At which phases this motor was seen to move, at the operating point in force.

    Parameters
    ----------
    setting
        Frequency (Hz), torque (N·m) and phase (degrees) of the last window.
    windows
        Windows of motion in a row at that setting.
    from_deg
        Smallest distance from standstill with proven motion, for negative and positive phases.
    """

    setting: tuple[float, float, float] = (0.0, 0.0, 0.0)
    windows: int = 0
    from_deg: tuple[float, float] = (inf, inf)


NOTHING_PROVEN = ProvenMotion()


def distance_deg(phase_deg: float) -> float:
    """Return how far a phase is from standstill; the travelling wave goes with sin φ.

    Parameters
    ----------
    phase_deg
        Phase shift.
    """
    return min(abs(phase_deg), 180.0 - abs(phase_deg))


def prove(proven: ProvenMotion, setting: tuple[float, float, float], moving: bool) -> ProvenMotion:
    """Take one driven window into account.

    Parameters
    ----------
    proven
        What the windows before have shown.
    setting
        Frequency (Hz), torque (N·m) and phase (degrees) in force.
    moving
        Whether the window showed motion.
    """
    if setting != proven.setting:
        same_point = setting[:2] == proven.setting[:2]
        kept = proven.from_deg if same_point else (inf, inf)
        return ProvenMotion(setting, int(moving), kept)
    windows = proven.windows + 1 if moving else 0
    if windows < WINDOWS_TO_PROVE:
        return replace(proven, windows=windows)
    negative, positive = proven.from_deg
    distance = distance_deg(setting[2])
    if setting[2] < 0:
        negative = min(negative, distance)
    else:
        positive = min(positive, distance)
    return ProvenMotion(setting, windows, (negative, positive))


def must_move(proven: ProvenMotion, phase_deg: float, settings: InterlockSettings) -> bool:
    """Return whether the motor has to move at a phase, if it is driven.

    Parameters
    ----------
    proven
        What the run has shown.
    phase_deg
        Phase shift.
    settings
        The limits.
    """
    shown_deg = proven.from_deg[0 if phase_deg < 0 else 1] + MARGIN_DEG
    return distance_deg(phase_deg) >= min(settings.no_motion_phase_deg, shown_deg)
