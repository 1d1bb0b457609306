"""A counter that drops the sign of the speed, and of its noise."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import identified, measured
from usmbench.diagnose.pipeline import diagnose


@pytest.mark.parametrize("seed", range(2))
def test_noise_that_lost_its_sign_is_no_load(seed: int) -> None:
    record = measured(60 + seed)
    noise_rad_s = 0.1 * np.random.default_rng([seed, 5]).standard_normal(record.t_s.size)
    unsigned = replace(record, speed_rad_s=np.abs(record.speed_rad_s + noise_rad_s))
    (cause,) = diagnose([unsigned], identified()).causes
    assert (cause.name, cause.form) == ("unsigned_counts", "with its noise")
    (found,) = cause.parameters
    assert found.low < np.hypot(0.1, 0.02) < found.high
