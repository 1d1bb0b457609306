"""How much an extension gains, and how sure that is."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.diagnose.fitting.gain import gain_of_blocks


def scores(before: float, after: float, floor: float, blocks: int = 40) -> np.ndarray:
    """Return sums of squares of blocks of 50 rows, alike but for chance."""
    rows = np.full(blocks, 50.0)
    chance = 1.0 + 0.05 * np.random.default_rng(1).standard_normal(blocks)
    return np.array([before * rows * chance, after * rows * chance, floor * rows, rows])


@pytest.mark.parametrize(("before", "least"), [(1.1, 0.0), (1.2, 0.2), (20.0, 0.97)])
def test_a_small_gain_is_as_unsure_as_the_noise_that_it_is_measured_by(
    before: float, least: float
) -> None:
    """Where the noise is said to be louder than what is left, the share is all of it, at most."""
    gain = gain_of_blocks(scores(before, 1.0, 1.05))
    assert gain.gain == gain.high == 1.0
    assert least < gain.low < 1.0
    assert before > 10.0 or gain.low < 0.9


@given(st.floats(0.5, 30.0), st.floats(0.5, 30.0), st.floats(0.1, 5.0))
def test_the_interval_holds_the_gain(before: float, after: float, floor: float) -> None:
    gain = gain_of_blocks(scores(before, after, floor))
    assert 0.0 <= gain.low <= gain.gain <= gain.high <= 1.0
    assert gain.noise_floor_rad_s <= max(gain.rmse_extended_rad_s, np.sqrt(floor)) + 1e-9
