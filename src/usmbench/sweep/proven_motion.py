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
    point
        Frequency (Hz) and torque (N·m) of the last window.
    moved_deg
        Phases of the last windows of motion in a row, of one sign.
    from_deg
        Smallest distance from standstill with proven motion, for negative and positive phases.
    """

    point: tuple[float, float] = (0.0, 0.0)
    moved_deg: tuple[float, ...] = ()
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


def prove(
    proven: ProvenMotion, point: tuple[float, float], phase_deg: float, moving: bool
) -> ProvenMotion:
    """Take one driven window into account.

    Of phases that glide, the farthest from standstill may have moved the rotor.

    Parameters
    ----------
    proven
        What the windows before have shown.
    point
        Frequency (Hz) and torque (N·m) in force.
    phase_deg
        Phase shift in force.
    moving
        Whether the window showed motion.
    """
    if point != proven.point:
        proven = ProvenMotion(point)
    if not moving:
        return replace(proven, moved_deg=())
    before_deg = [p for p in proven.moved_deg if (p < 0) == (phase_deg < 0)]
    moved_deg = (*before_deg, phase_deg)[-WINDOWS_TO_PROVE:]
    if len(moved_deg) < WINDOWS_TO_PROVE:
        return replace(proven, moved_deg=moved_deg)
    from_deg = list(proven.from_deg)
    side = 0 if phase_deg < 0 else 1
    from_deg[side] = min(from_deg[side], max(map(distance_deg, moved_deg)))
    return ProvenMotion(point, moved_deg, (from_deg[0], from_deg[1]))


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
