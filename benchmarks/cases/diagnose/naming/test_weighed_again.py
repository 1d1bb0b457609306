"""Rivals of two causes weighed once more, in the motor that shows both."""

from dataclasses import replace

import numpy as np

from known_motor import applied, driven, identified
from usmbench.diagnose.pipeline import diagnose


def test_no_rival_is_rebuilt_by_a_gain_that_wanders_far_beyond_chance() -> None:
    """In a motor that shows the hysteresis, a speed of nothing and another gain look like it."""
    known = {**identified().residual["diagnosis"], "gain": 0.01}
    wandering = replace(identified(), residual={**identified().residual, "diagnosis": known})
    rng, share = np.random.default_rng(6), np.arange(3000) / 3000.0
    waves = [np.cos(2.0 * np.pi * (k * share + rng.uniform())) for k in range(3, 60)]
    phase_deg = np.round(85.0 * sum(waves) / np.max(np.abs(sum(waves))), 1)
    sticks = applied("dead_zone_hysteresis", "sticking", start_later_deg=20.0)
    grid = applied("phase_quantisation", "cut off", step_deg=1.3424)
    causes = diagnose([driven(phase_deg, 1, sticks, grid)], wandering).causes
    assert [c.name for c in causes] == ["dead_zone_hysteresis", "phase_quantisation"]
    assert [c.alternatives for c in causes] == [(), ()]
