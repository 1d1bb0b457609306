"""What most rows near a phase are, a few of them do not change, nor the order of the rows."""

import numpy as np

from usmbench.identify.like_phases import median_at_like_phases, merged_deg


def test_it_follows_the_phase_and_no_single_row() -> None:
    rng = np.random.default_rng(2)
    phase_deg = rng.uniform(-90.0, 90.0, 4000)
    values = np.where(phase_deg > 20.0, 3.0, -1.0)
    struck = values.copy()
    struck[::10] += 50.0
    away = np.abs(phase_deg - 20.0) > 2.0
    np.testing.assert_array_equal(median_at_like_phases(struck, phase_deg)[away], values[away])


def test_levels_that_differ_by_rounding_are_one() -> None:
    rng = np.random.default_rng(1)
    levels_deg = np.linspace(-90.0, 90.0, 13)
    phases_deg = [rng.choice(levels_deg, 300) for _ in range(2)]
    rounded_deg = [p + rng.uniform(-1e-6, 1e-6, p.size) for p in phases_deg]
    assert np.unique(np.concatenate(merged_deg(rounded_deg))).size == 13
    for before, after in zip(phases_deg, merged_deg(phases_deg), strict=True):
        np.testing.assert_array_equal(after, before)


def test_phases_of_a_record_that_glides_are_left_as_they_are() -> None:
    fast_deg = np.linspace(-90.0, 90.0, 2000)
    slow_deg = np.linspace(-90.0, 90.0, 200_000)  # each as near to the next as rounding is
    for phase_deg in (fast_deg, slow_deg):
        (merged,) = merged_deg([phase_deg])
        np.testing.assert_array_equal(merged, phase_deg)
