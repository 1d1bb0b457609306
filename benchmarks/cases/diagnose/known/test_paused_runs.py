"""A motor that loses speed as it warms, in runs that were paused: what is known foretells it."""

import numpy as np
import pytest

from known_motor import WINDOW_S
from tests.usmbench.diagnose.known.resting_motor import AT, CONSTANT_S, LOSES, day, model
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.residual.own_effects import cut_beside_own, known_of

PAUSES_S = (300.0, 1000.0, 3500.0)


@pytest.mark.parametrize("pause_s", PAUSES_S)
@pytest.mark.parametrize("seed", range(2))
def test_after_a_pause_it_is_foretold_as_fast_as_it_is_cold(seed: int, pause_s: float) -> None:
    known = known_of(model(seed))
    *_, after = cut_beside_own([day(100 * seed + 50, pause_s)], model(seed))[0]
    fast = after.use & (np.abs(after.simulated_rad_s) > 5.0)
    left_rad_s = after.residual_rad_s - known.expected_rad_s(after)
    share = np.mean(left_rad_s[fast] / after.simulated_rad_s[fast])
    cooled = LOSES * -np.expm1(-AT * WINDOW_S / CONSTANT_S)
    assert abs(share) < 0.1 * cooled


@pytest.mark.parametrize(("seed", "goes_on"), [(0, False), (1, True)])
def test_a_gap_is_no_cause_either_where_nobody_knows_what_the_motor_did(
    seed: int, goes_on: bool
) -> None:
    record = day(100 * seed + 70, 300.0, says=False, goes_on=goes_on)
    assert record.driven is None
    assert diagnose([record], model(seed)).verdict == "no_discrepancy"


@pytest.mark.parametrize(("seed", "pause_s"), [(0, 300.0), (1, 3500.0)])
def test_a_pause_is_no_cause(seed: int, pause_s: float) -> None:
    found = diagnose([day(100 * seed + 60, pause_s)], model(seed))
    assert found.verdict == "no_discrepancy"
    assert not any("longer than" in words for words in found.warnings)
