import numpy as np
import pytest

from usmbench.model.lagged import lagged


def test_a_step_is_followed_with_the_time_constant() -> None:
    window_s, constant_s = 0.01, 0.2
    after_s = window_s * np.arange(1, 101)
    found = lagged(np.full(100, 3.0), np.exp(-window_s / constant_s), 1.0)
    assert found == pytest.approx(3.0 - 2.0 * np.exp(-after_s / constant_s))


def test_what_stays_is_not_changed() -> None:
    assert lagged(np.full(10, 2.5), 0.9, 2.5) == pytest.approx(np.full(10, 2.5))
