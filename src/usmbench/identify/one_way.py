"""Whether runs count alike which way a motor turns."""

from collections.abc import Sequence

import numpy as np

from usmbench.errors import InputError
from usmbench.identify.wild_rows import wild_rows
from usmbench.runs.record import Record

_PLAIN = 0.5  # cosine between speed and sin φ, over the rows; nothing measured sets it


def check_one_way(records: Sequence[Record]) -> None:
    """Refuse runs of which some turn the other way at like phases: no curve goes through them.

    Parameters
    ----------
    records
        The runs.

    Raises
    ------
    usmbench.errors.InputError
        There are such; the message names both sides, the fewer first.
    """
    ways = [_way(record) for record in records]
    names = {way: [r.name for r, w in zip(records, ways, strict=True) if w == way] for way in ways}
    one, other = sorted((names.get(1, []), names.get(-1, [])), key=len)
    if one:
        raise InputError(
            f"{' and '.join(one)}: of the other direction at like phases than "
            f"{' and '.join(other)}; change the sign of the speeds or phases of the wrong ones, or "
            "leave them out"
        )


def _way(record: Record) -> int:
    """Return 1 where a run turns forward at positive phases, −1 backward, 0 where it is unclear."""
    used = ~wild_rows(record)
    if record.driven is not None:
        used &= record.driven
    speed, drive = record.speed_rad_s[used], np.sin(np.radians(record.phase_deg[used]))
    plain = _PLAIN * float(np.linalg.norm(speed) * np.linalg.norm(drive))
    along = float(speed @ drive)
    return int(np.sign(along)) if abs(along) > plain else 0
