"""Healthy motors whose dead zone wanders, however they start."""

from benchmarks.healthy_days import Healthy, draw
from benchmarks.plain_motor import CURVES

N = 1500


def test_a_dead_zone_that_wanders_gets_no_name_however_the_motor_starts() -> None:
    kinds, passes_for_it = list(CURVES), {"load_torque", "phase_offset", "gain_asymmetry"}
    for curve in ("steep", "gentle"):
        found = draw(71, 2 * len(kinds) + kinds.index(curve), N)
        assert (found.wander, found.curve) == (0.01, curve)
        assert not passes_for_it & set(found.names)


def test_a_motor_with_nothing_wrong_gets_no_name() -> None:
    assert draw(71, 0, 400) == Healthy(0.0, "smooth", "no_discrepancy", ())
