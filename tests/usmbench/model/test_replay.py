"""A model beside a run that was paused: at rest after each pause, and as much cooler."""

from dataclasses import replace

import numpy as np
import pytest

from drifting_motor import drifting_motor, paused_run
from usmbench.model.replay import replay_record


@pytest.mark.parametrize("pauses_s", [(), (3.0,), (300.0,), (7.0, 5.0), (40.0, 3600.0)])
@pytest.mark.parametrize("seed", range(3))
def test_a_drift_goes_back_while_the_motor_stands(seed: int, pauses_s: tuple[float, ...]) -> None:
    record = paused_run(seed, pauses_s)
    simulated = replay_record(record, drifting_motor()).simulation
    np.testing.assert_allclose(simulated.speed_rad_s, record.speed_rad_s, atol=1e-9)


def test_a_lost_row_stops_no_motor() -> None:
    record = replace(paused_run(0, ()), extra={})
    kept = np.arange(record.t_s.size) != 400
    simulated = replay_record(record.rows(kept), drifting_motor()).simulation
    whole = replay_record(record, drifting_motor()).simulation
    np.testing.assert_allclose(simulated.speed_rad_s, whole.speed_rad_s[kept], atol=0.02)
