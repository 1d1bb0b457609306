"""What most rows near a phase are, a few of them do not change, nor the order of the rows."""

import numpy as np

from usmbench.identify.like_phases import median_at_like_phases


def test_it_follows_the_phase_and_no_single_row() -> None:
    rng = np.random.default_rng(2)
    phase_deg = rng.uniform(-90.0, 90.0, 4000)
    values = np.where(phase_deg > 20.0, 3.0, -1.0)
    struck = values.copy()
    struck[::10] += 50.0
    away = np.abs(phase_deg - 20.0) > 2.0
    np.testing.assert_array_equal(median_at_like_phases(struck, phase_deg)[away], values[away])
