"""Whether the shaft's angle in a run goes with its speed."""

import numpy as np

from usmbench.runs.record import Record

_ALIKE = 2.0  # times: as far as a counter may differ from it, and no unit does
_MOVES, _FEWEST = 0.1, 20  # of the highest speed; windows
_QUARTER_TURN_RAD = 0.5 * np.pi  # a window; far beyond, a wrapped angle tells nothing


def angle_goes_with_speed(record: Record) -> bool:
    """Return whether the angle turns by as much as the speed says, whatever the direction.

    Parameters
    ----------
    record
        The run; one without angles, or with too few windows of motion, says nothing against them.
    """
    if record.angle_rad is None:
        return True
    turned = (np.diff(record.angle_rad) + np.pi) % (2.0 * np.pi) - np.pi
    expected_rad = np.abs(record.speed_rad_s * record.window_s)[1:]
    moves = expected_rad > _MOVES * np.max(expected_rad, initial=0.0)
    moves &= expected_rad < _QUARTER_TURN_RAD
    if np.count_nonzero(moves) < _FEWEST:
        return True
    share = float(np.median(np.abs(turned[moves]) / expected_rad[moves]))
    return 1.0 / _ALIKE < share < _ALIKE


def angle_warnings(record: Record) -> list[str]:
    """Say where an angle is not used.

    Parameters
    ----------
    record
        The run.
    """
    if angle_goes_with_speed(record):
        return []
    return [
        f"{record.name}: angle_rad does not turn as speed_rad_s says and is not used; is it in "
        "rad, and at the end of each window?"
    ]
