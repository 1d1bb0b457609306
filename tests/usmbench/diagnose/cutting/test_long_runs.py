"""Runs that last longer than those that showed how their motor warms."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.diagnose.cutting.long_runs import long_warming
from usmbench.diagnose.cutting.stretches import Stretch


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
