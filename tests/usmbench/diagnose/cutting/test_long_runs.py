"""Runs that last longer than those that showed how their motor warms."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.diagnose.cutting.long_runs import lasts_s, long_warming
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.model.driving import driving


@pytest.mark.parametrize(("lasts_s", "warns"), [(70.0, False), (99.0, False), (120.0, True)])
def test_a_run_says_that_its_model_was_not_watched_as_long(
    stretches: list[Stretch], lasts_s: float, warns: bool
) -> None:
    (stretch,) = stretches
    t_s = 1000.0 + np.linspace(0.0, lasts_s, 200)  # a clock need not begin at 0
    long = replace(stretch, context=replace(stretch.context, t_s=t_s))
    # Of lags of 10, 32 and 100 s.
    warnings = long_warming([long], 3)
    assert [stretch.name in words for words in warnings] == [True] * warns
    assert not long_warming([long], 4)


@pytest.mark.parametrize("pause_s", [300.0, 3500.0])
def test_the_time_without_drive_does_not_count(stretches: list[Stretch], pause_s: float) -> None:
    (stretch,) = stretches
    before_s, after_s = (
        0.01 * np.arange(1.0, 3001.0),
        30.0 + pause_s + 0.01 * np.arange(1.0, 3001.0),
    )
    t_s, driven = np.r_[before_s, after_s], np.full(6000, True)
    driven[3000:3005] = False
    paused = driving(t_s, 0.01, driven)
    parts = [
        replace(stretch, context=replace(stretch.context, t_s=part_s, driving=paused))
        for part_s in (before_s, after_s)
    ]
    assert lasts_s(parts)[stretch.name] == pytest.approx(59.95, abs=0.02)
    assert not long_warming(parts, 3)
