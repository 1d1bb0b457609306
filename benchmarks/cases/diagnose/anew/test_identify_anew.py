"""A model that was identified on speeds without sign is identified anew with the loss in place."""

import numpy as np
import pytest

from tests.usmbench.diagnose.anew.counted_shaft import (
    PLAIN,
    counted_run,
    diagnosed,
    found_again,
)
from usmbench.model.applied import Applied
from usmbench.model.effects.registry import find_effect

RECTIFIED = Applied(
    find_effect("unsigned_counts", "rectified"), {"knee_rad_s": 1.0, "smoothing_s": 0.04}
)
NOISY = Applied(find_effect("unsigned_counts", "with its noise"), {"noise_rad_s": 0.2})


@pytest.mark.parametrize("blindness", [PLAIN, RECTIFIED, NOISY])
def test_the_loss_of_sign_is_named_and_the_motor_found_again(blindness: Applied) -> None:
    found_again(blindness)


@pytest.mark.parametrize("seed", range(2))
def test_short_and_noisy_runs_show_the_loss_too(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, noise_rad_s = int(rng.integers(300, 500)), rng.uniform(0.02, 0.1)
    found = diagnosed(counted_run(seed, [PLAIN], rng.uniform(0.5, 1.0), n, noise_rad_s))
    assert [cause.name for cause in found.causes] == ["unsigned_counts"]


@pytest.mark.parametrize("seed", range(2))
def test_a_motor_that_stands_still_one_way_is_not_called_blind(seed: int) -> None:
    # Its counter tells which way: a blind one would fold what the belt swings back.
    found = diagnosed(counted_run(seed, [], backwards=0.0))
    assert not found.causes
