"""The colour of what a simulation leaves."""

import numpy as np
import pytest
from scipy.signal import lfilter

from usmbench.identify.noise import fit_noise


def test_a_row_between_two_gaps_does_not_hide_the_colour() -> None:
    white = np.random.default_rng(0).standard_normal(5000)
    coloured = lfilter([1.0], [1.0, -0.8], white)
    ar, left = fit_noise([coloured[:2500], np.array([0.3]), coloured[2500:]])
    assert ar == pytest.approx([0.8], abs=0.03)
    assert left == pytest.approx(1.0, rel=0.03)


def test_residuals_that_are_all_0_have_no_colour() -> None:
    ar, left = fit_noise([np.zeros(100)])
    assert (ar.size, left) == (0, 0.0)
