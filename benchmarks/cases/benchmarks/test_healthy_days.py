"""Healthy motors whose dead zone wanders, however they start."""

from benchmarks.healthy_days import draw
from benchmarks.plain_motor import CURVES

N = 1500


def test_a_dead_zone_that_wanders_gets_no_name_however_the_motor_starts() -> None:
    kinds, passes_for_it = list(CURVES), {"load_torque", "phase_offset", "gain_asymmetry"}
    for curve in ("steep", "gentle"):
        found = draw(71, 2 * len(kinds) + kinds.index(curve), N)
        assert (found.wander, found.curve) == (0.01, curve)
        assert not passes_for_it & set(found.names)
