"""A soft shaft whose coupling damps is named alone."""

import math
from dataclasses import replace

import numpy as np
import pytest

from known_motor import CURVE, NOISE_RAD_S, WINDOW_S, identified, measured
from usmbench.diagnose.pipeline import diagnose

TAU_S, DEAD_TIME_S = 0.0035, 0.0015


@pytest.mark.parametrize(("period_s", "damping"), [(0.033, 0.07), (0.085, 0.22)])
def test_a_disc_that_its_coupling_damps_is_named_alone(period_s: float, damping: float) -> None:
    healthy, natural, steps = measured(7), 2.0 * math.pi / period_s, 50
    step_s, late = WINDOW_S / steps, round(DEAD_TIME_S * steps / WINDOW_S)
    held_rad_s = np.repeat(CURVE.speed_rad_s(healthy.phase_deg), steps)
    held_rad_s = np.r_[np.full(late, held_rad_s[0]), held_rad_s[:-late]]
    rotor = disc = float(held_rad_s[0])
    twist, disc_rad_s = 0.0, np.empty(held_rad_s.size)
    for k, speed in enumerate(held_rad_s.tolist()):
        rotor = speed + (rotor - speed) * math.exp(-step_s / TAU_S)
        twist += step_s * (rotor - disc)
        disc += step_s * (natural**2 * twist + 2.0 * damping * natural * (rotor - disc))
        disc_rad_s[k] = disc
    noise_rad_s = NOISE_RAD_S * np.random.default_rng(5).standard_normal(healthy.t_s.size)
    seen = disc_rad_s.reshape(-1, steps).mean(axis=1) + noise_rad_s
    (cause,) = diagnose([replace(healthy, speed_rad_s=seen)], identified()).causes
    assert (cause.name, cause.form) == ("shaft_compliance", "damped in the coupling")
    assert [p.value for p in cause.parameters] == pytest.approx([period_s, damping], rel=0.1)
