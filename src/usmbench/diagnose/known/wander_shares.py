"""How far runs may differ though nothing is wrong, where they do not show it themselves."""

from typing import NamedTuple


class Shares(NamedTuple):
    """Standard deviations from run to run, alike at every operating point.

    Parameters
    ----------
    gain, tilt, wider, one_sided, one_sided_ends, warms_gain, warms_wider, warms_shift
        Shares, as in `Wander`.
    late_s
        In s.
    stuck, held, warms_held
        What are speeds in `Wander`, as shares of the highest.
    """

    gain: float
    tilt: float
    late_s: float
    stuck: float
    wider: float
    one_sided: float
    one_sided_ends: float
    held: float
    warms_gain: float
    warms_held: float
    warms_wider: float
    warms_shift: float


LEAST = Shares(
    gain=3e-4,
    tilt=5e-5,
    late_s=3e-6,
    stuck=2e-4,
    wider=1e-3,
    one_sided=3e-4,
    one_sided_ends=3e-4,
    held=2e-4,
    warms_gain=1e-3,
    warms_held=1e-3,
    warms_wider=1e-3,
    warms_shift=2e-5,
)
"""Repeatability that one run cannot show."""
ANY = Shares(
    gain=0.05,
    tilt=0.01,
    late_s=1e-4,
    stuck=0.02,
    wider=0.05,
    one_sided=0.01,
    one_sided_ends=0.01,
    held=0.02,
    warms_gain=0.01,
    warms_held=0.01,
    warms_wider=0.05,
    warms_shift=2e-4,
)
"""What it may be while it is learnt."""
