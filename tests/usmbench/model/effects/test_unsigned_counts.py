"""A counter that drops the sign of the speed, and of its noise."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from known_motor import LINEAR, WINDOW_S
from usmbench.model.effects.context import Context
from usmbench.model.effects.unsigned_counts import WithItsNoise

CONTEXT = Context(np.zeros(1), WINDOW_S, np.zeros(1), lambda phase_deg: phase_deg, LINEAR)


@given(speed_rad_s=st.floats(-20.0, 20.0), noise_rad_s=st.floats(0.0, 1.0))
def test_its_mean_is_that_of_the_size_of_a_noisy_speed(
    speed_rad_s: float, noise_rad_s: float
) -> None:
    drawn = speed_rad_s + noise_rad_s * np.random.default_rng(1).standard_normal(20_000)
    (mean,) = WithItsNoise().apply(np.array([speed_rad_s]), CONTEXT, {"noise_rad_s": noise_rad_s})
    assert mean == pytest.approx(np.mean(np.abs(drawn)), abs=0.04 * noise_rad_s + 1e-9)
