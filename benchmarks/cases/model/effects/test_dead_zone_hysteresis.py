"""Starts that differ by direction have one name; a motor that leads has no hysteresis."""

from dataclasses import replace

import numpy as np
import pytest

import known_motor
from known_motor import UP_AND_DOWN_DEG, applied, driven, identified
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.linear import free_run


@pytest.mark.parametrize("seed", range(2))
def test_starts_that_take_more_one_way_than_the_other_have_one_name(seed: int) -> None:
    rng = np.random.default_rng([seed, 4])
    forwards_deg, backwards_deg = rng.permutation([rng.uniform(3.0, 5.0), rng.uniform(8.0, 12.0)])
    hidden = applied(
        "dead_zone_hysteresis",
        "sticking, each way its own",
        forwards_later_deg=forwards_deg,
        backwards_later_deg=backwards_deg,
    )
    phase_deg = np.repeat(rng.uniform(-60.0, 60.0, 300), 5)
    (cause,) = diagnose([driven(phase_deg, seed, hidden)], identified()).causes
    assert (cause.name, cause.form) == ("dead_zone_hysteresis", "sticking, each way its own")
    found = [p.value for p in cause.parameters]
    assert found == pytest.approx([forwards_deg, backwards_deg], abs=1.2)


def test_a_motor_that_leads_has_no_hysteresis() -> None:
    healthy = driven(np.tile(np.repeat(UP_AND_DOWN_DEG, 2), 7), 3)
    early = replace(healthy, speed_rad_s=np.roll(healthy.speed_rad_s, -1))
    found = diagnose([early], identified())
    assert "dead_zone_hysteresis" not in [cause.name for cause in found.causes]
    assert found.verdict in ("unexplained", "partly_explained")


def test_a_start_that_is_later_and_a_stop_that_is_not_have_one_name() -> None:
    draw = np.random.default_rng([1, 19])
    width_deg = draw.uniform(2.0, 6.0)
    stairs_deg = np.repeat(np.round(draw.uniform(-88.0, 88.0, 400), 1), 5)
    farther, last = np.zeros(2000), 0.0
    for k in range(1, 2000):
        grew = abs(stairs_deg[k]) - abs(stairs_deg[k - 1])
        last = width_deg if grew > 0.0 else 0.0 if grew < 0.0 else last
        farther[k] = last
    size_deg = np.abs(stairs_deg) - farther
    healthy = driven(stairs_deg, 1)
    curve = known_motor.CURVE.speed_rad_s
    change = curve(np.sign(stairs_deg) * size_deg) - curve(stairs_deg)
    speed_rad_s = healthy.speed_rad_s + free_run(known_motor.LINEAR, change, 0.0)
    found = diagnose([replace(healthy, speed_rad_s=speed_rad_s)], identified())
    (cause,) = found.causes
    assert cause.name == "dead_zone_hysteresis"
    assert found.verdict == "explained"
    (size,) = cause.parameters
    assert size.value == pytest.approx(width_deg, rel=0.1)
