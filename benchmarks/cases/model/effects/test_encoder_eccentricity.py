"""A disc that is off centre beside one that is tilted."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import WINDOW_S, identified, measured
from usmbench.diagnose.pipeline import diagnose
from usmbench.runs.record import Record


@pytest.mark.parametrize("seed", range(2))
def test_a_disc_off_centre_is_named_beside_a_tilt_and_a_tilt_alone_is_not(seed: int) -> None:
    draw = np.random.default_rng([seed, 41])
    ripple, share, turn = draw.uniform(0.03, 0.08), draw.uniform(0.1, 0.35), draw.uniform(0, 6, 2)
    healthy = measured(60 + seed)
    angle_rad = np.cumsum(healthy.speed_rad_s) * WINDOW_S

    def seen(once: float, twice: float) -> Record:
        first = once * np.cos(angle_rad + turn[0])
        second = twice * np.cos(2.0 * angle_rad + turn[1])
        return replace(
            healthy,
            speed_rad_s=healthy.speed_rad_s * (1.0 + first + second),
            angle_rad=angle_rad,
        )

    both = diagnose([seen(ripple, share * ripple)], identified())
    assert [cause.name for cause in both.causes] == ["encoder_eccentricity"]
    assert both.verdict == "explained"
    assert diagnose([seen(0.0, ripple)], identified()).causes == ()
