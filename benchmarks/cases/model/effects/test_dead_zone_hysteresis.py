"""Starts that differ by direction have one name; a motor that leads has no hysteresis."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import UP_AND_DOWN_DEG, applied, driven, identified
from usmbench.diagnose.pipeline import diagnose


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
