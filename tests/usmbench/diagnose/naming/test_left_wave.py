"""What is left swings in a wave, or has no pattern."""

import numpy as np
import pytest

from known_motor import WINDOW_S, identified, measured
from usmbench.diagnose.naming.left_wave import left_wave_hz
from usmbench.diagnose.residual.own_effects import cut_beside_own


@pytest.mark.parametrize("share", [0.0, 0.4])
def test_noise_is_no_wave_though_some_of_it_may_be(share: float) -> None:
    stretches, _ = cut_beside_own([measured(13)], identified())
    t_s = stretches[0].context.t_s
    wave = np.sqrt(2.0 * share) * np.sin(2.0 * np.pi * 7.0 * t_s)
    rest = np.sqrt(1.0 - share) * np.random.default_rng(1).standard_normal(t_s.size)
    left = [wave + rest, *[np.zeros(1) for _ in stretches[1:]]]
    assert left_wave_hz(stretches, left) is None


def test_a_few_windows_tell_no_wave() -> None:
    stretches, _ = cut_beside_own([measured(13)], identified())
    few = np.sin(2.0 * np.pi * 10.0 * WINDOW_S * np.arange(20.0))
    assert left_wave_hz(stretches[:1], [few]) is None
