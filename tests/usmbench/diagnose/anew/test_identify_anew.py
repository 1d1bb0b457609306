"""A model that was identified on speeds without sign is identified anew with the loss in place."""

from dataclasses import replace

import numpy as np
import pytest

from tests.usmbench.diagnose.anew.counted_shaft import (
    PLAIN,
    counted_run,
    diagnosed,
    shaft,
)
from usmbench.model.applied import Applied
from usmbench.model.effects.registry import find_effect
from usmbench.model.simulate import simulate

NOISY = Applied(find_effect("unsigned_counts", "with its noise"), {"noise_rad_s": 0.2})
RECTIFIED = Applied(
    find_effect("unsigned_counts", "rectified"), {"knee_rad_s": 1.0, "smoothing_s": 0.04}
)


@pytest.mark.parametrize("blindness", [PLAIN, NOISY, RECTIFIED])
def test_the_loss_of_sign_is_named_and_the_motor_found_again(blindness: Applied) -> None:
    found = diagnosed(counted_run(1, [blindness]))
    (cause,) = found.causes
    assert cause.name == "unsigned_counts"
    assert cause.form == blindness.effect.form
    assert found.gain > 0.8
    for estimate in cause.parameters:
        assert estimate.low <= blindness.values[estimate.name] <= estimate.high
    fresh = counted_run(2, [blindness]).phase_deg.clip(-55.0, 75.0)
    seeing = simulate(replace(found.extended, effects=()), fresh).speed_rad_s
    expected = shaft(fresh, 1.0)
    # Which way is forward cannot be seen.
    apart = min(np.std((sign * seeing - expected)[50:]) for sign in (1.0, -1.0))
    assert apart < 0.1 * np.std(expected)
