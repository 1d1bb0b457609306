"""Small versions of the encoder path: what the load of the machine cannot change."""

import importlib.util
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "benchmarks" / "encoder_path.py"


@pytest.fixture(scope="module")
def encoder_path() -> Any:
    spec = importlib.util.spec_from_file_location("encoder_path", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("rate_hz", [1e5, 1e6])
def test_lock_step_loses_nothing_and_times_edges(encoder_path: Any, rate_hz: float) -> None:
    result = encoder_path.measure(encoder_path.Setup(rate_hz, lock_step=True), 80)
    assert result.lost == 0
    assert encoder_path.rms_percent(result.edge_timed_error) <= 0.05
    assert encoder_path.rms_percent(result.average_error) > 0.5


def test_real_time_loses_nothing_and_is_never_early(encoder_path: Any) -> None:
    result = encoder_path.measure(encoder_path.Setup(1e5, lock_step=False), 50)
    assert result.lost == 0
    assert result.latency_s.min() > 0.0


def test_a_lost_block_is_counted(encoder_path: Any) -> None:
    setup = encoder_path.Setup(1e5, lock_step=True)
    counts_per_sample = setup.speed_rad_s / encoder_path.RAD_PER_COUNT / setup.rate_hz
    ends = np.array([1000, 2000, 4000, 5000])
    lasts = np.floor(ends * counts_per_sample).astype(np.int64)
    assert encoder_path.lost_blocks(lasts, 1000, setup) == 2
