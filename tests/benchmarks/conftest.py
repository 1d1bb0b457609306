"""A motor that several campaigns' tests share: identified once."""

import pytest

from benchmarks.campaign_bench import SMALL_REFERENCE_S, MotorBench
from benchmarks.campaign_runs import Motor


@pytest.fixture(scope="session")
def motor_bench(tmp_path_factory: pytest.TempPathFactory) -> MotorBench:
    folder = tmp_path_factory.mktemp("campaign")
    return MotorBench(folder, folder, Motor(4), SMALL_REFERENCE_S)
