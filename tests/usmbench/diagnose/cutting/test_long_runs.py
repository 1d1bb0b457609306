"""Runs that last longer than those that naming is measured on."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.diagnose.cutting.long_runs import long_warming
from usmbench.diagnose.cutting.stretches import Stretch


@pytest.mark.parametrize(("apart_s", "warns"), [(0.34, False), (0.36, True)])
def test_a_long_run_says_that_its_warm_up_is_not_known(
    stretches: list[Stretch], apart_s: float, warns: bool
) -> None:
    (stretch,) = stretches
    t_s = 1000.0 + apart_s * np.arange(200.0)  # a clock need not begin at 0
    warnings = long_warming([replace(stretch, context=replace(stretch.context, t_s=t_s))])
    assert [stretch.name in words for words in warnings] == [True] * warns
