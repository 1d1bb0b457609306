"""A motor that tests and cases of several campaigns share: identified once."""

import pytest

from benchmarks.campaign_bench import SMALL_REFERENCE_S, MotorBench
from benchmarks.campaign_runs import PLANS, Excited, Motor


@pytest.fixture(scope="session")
def motor_bench(tmp_path_factory: pytest.TempPathFactory) -> MotorBench:
    folder = tmp_path_factory.mktemp("campaign")
    # At one drive frequency, without the neighbours that show the slope: these take most of it.
    driven = (Excited(kind, SMALL_REFERENCE_S, 900 + k) for k, kind in enumerate(PLANS))
    return MotorBench(folder, folder, Motor(4), driven)
