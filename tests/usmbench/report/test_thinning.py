"""What is left of a long line."""

import numpy as np

from usmbench.report.thinning import thinned


def test_thinning_keeps_every_extreme() -> None:
    rng = np.random.default_rng(1)
    x, y = np.arange(10_003.0), rng.standard_normal(10_003)
    y[[5, 8765, 10_002]] = 9.0, -9.0, 8.0
    few_x, few_y = thinned(x, y, 100)
    assert few_x.size <= 200
    assert np.all(np.diff(few_x) > 0.0)
    assert {5.0, 8765.0, 10_002.0} <= set(few_x)
    assert (few_y.max(), few_y.min()) == (9.0, -9.0)
