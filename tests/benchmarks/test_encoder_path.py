"""Small versions of the encoder path: what the load of the machine cannot change."""

import numpy as np
import pytest

from benchmarks import encoder_path


@pytest.mark.parametrize("rate_hz", [1e5, 1e6])
def test_lock_step_loses_nothing_and_times_edges(rate_hz: float) -> None:
    result = encoder_path.measure(encoder_path.Setup(rate_hz, lock_step=True), 80)
    assert result.lost == 0
    assert encoder_path.rms_percent(result.edge_timed_error) <= 0.05
    assert encoder_path.rms_percent(result.average_error) > 0.5


def test_real_time_loses_nothing_and_is_never_early() -> None:
    result = encoder_path.measure(encoder_path.Setup(1e5, lock_step=False), 50)
    assert result.lost == 0
    assert result.latency_s.min() > 0.0


def test_a_lost_block_is_counted() -> None:
    speed_rad_s = 10.25
    setup = encoder_path.Setup(1e5, lock_step=True, speed_rad_s=speed_rad_s)
    counts_per_sample = speed_rad_s / encoder_path.RAD_PER_COUNT / setup.rate_hz
    ends = np.array([1000, 2000, 4000, 5000])
    lasts = np.floor(ends * counts_per_sample).astype(np.int64)
    assert encoder_path.lost_blocks(lasts, 1000, setup) == 2
