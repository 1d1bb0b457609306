"""Dwells that are no whole number of windows: found, and no cause is named for them."""

import numpy as np
import pytest

from known_motor import WINDOW_S, applied, driven, identified
from tests.usmbench.diagnose.cutting.uneven_dwells import (
    dwelling_run,
    known_dwelling,
)
from usmbench.diagnose.cutting.command_times import keeps_own_time
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.hammerstein import HammersteinModel


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return known_dwelling()


@pytest.mark.parametrize("seed", range(2, 4))
def test_a_healthy_run_of_such_dwells_is_no_swinging_shaft(
    model: HammersteinModel, seed: int
) -> None:
    found = diagnose([dwelling_run(seed)], model)
    assert found.verdict == "no_discrepancy"
    assert any("at moments within the windows" in warning for warning in found.warnings)


def test_a_triangle_of_fine_steps_keeps_step() -> None:
    # At its crests a phase is held for two windows, elsewhere for one.
    up_deg, model = np.arange(-88.0, 88.1, 2.2), identified()
    wrong = applied("speed_scale", "", scale_error=-0.024)
    record = driven(np.tile(np.r_[up_deg, up_deg[::-1]], 6), 3, wrong)
    assert not any(keeps_own_time(s) for s in cut_runs([record], model, ())[0])
    found = diagnose([record], model)
    assert "speed_scale" in (found.causes[0].name, *found.causes[0].alternatives)
    assert found.warnings == ()


def test_a_delay_of_two_windows_is_named_still(model: HammersteinModel) -> None:
    (first, *_) = diagnose([dwelling_run(7, late_s=2.2 * WINDOW_S)], model).causes
    assert first.name == "transport_delay"
    (delay,) = first.parameters
    assert delay.value == pytest.approx(2.2 * WINDOW_S, rel=0.1)
