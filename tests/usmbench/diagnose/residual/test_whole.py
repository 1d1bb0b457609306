"""What is left beside a name takes it away only where it is a finding of its own."""

import pytest

from usmbench.diagnose.residual.whole import Whole, verdict
from usmbench.diagnose.result import Verdict

N_ROWS = 1000


@pytest.mark.parametrize(
    ("excess", "p_value", "says"),
    [
        (50.0, 0.01, "explained"),
        (5.0, 1e-6, "explained"),
        (90.0, 1e-6, "partly_explained"),
        (150.0, 1e-6, "unexplained"),
    ],
    ids=["chance", "a small share", "a trifle", "a finding"],
)
def test_a_name_stands_beside_a_trifle(excess: float, p_value: float, says: Verdict) -> None:
    before, after = Whole(200.0, 0.0, N_ROWS), Whole(excess, p_value, N_ROWS)
    assert verdict(before, after, 40.0) == says
