"""A curve that takes phases beyond a bend for outliers says so."""

import re

import numpy as np
import pytest

from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.runs.record import Record


@pytest.mark.parametrize("saturates", [True, False])
def test_a_bend_that_few_samples_show_is_told(saturates: bool) -> None:
    """A line that saturates at -70 degrees, driven beyond in one window of a hundred."""
    rng = np.random.default_rng(1)
    n = 2000
    phase_deg = np.round(rng.uniform(-60.0, 88.0, n), 1)
    phase_deg[::100] = np.round(rng.uniform(-120.0, -85.0, n // 100), 1)
    settled = 0.15 * (np.maximum(phase_deg, -70.0) if saturates else phase_deg)
    speed_rad_s = settled + 0.01 * rng.standard_normal(n)
    t_s = 0.03 * np.arange(1.0, n + 1.0)
    record = Record("run", t_s, phase_deg, speed_rad_s, np.full(n, 0.03))
    found = identify_fast([record], FastOptions(degree=4))
    told = [w for w in found.warnings if "as if they were outliers" in w]
    assert len(told) == int(saturates)
    assert all(-120.0 <= float(re.findall(r"most at (-\S+)°", w)[0]) <= -85.0 for w in told)
