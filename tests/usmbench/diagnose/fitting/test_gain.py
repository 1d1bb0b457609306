"""What a gain says of a name."""

import pytest

from usmbench.diagnose.fitting.gain import Gain


@pytest.mark.parametrize(
    ("before", "after", "gain", "none"),
    [
        (0.1, 0.05, 1.0, False),
        (0.1, 0.101, 0.0, True),
        (0.1, 0.099, 0.03, True),  # of twice the noise, what matters is something else
        (0.051, 0.0508, 0.05, False),
    ],
)
def test_what_gains_nothing_is_no_name(
    before: float, after: float, gain: float, none: bool
) -> None:
    assert Gain(before, after, 0.05, gain, gain, gain).none == none
