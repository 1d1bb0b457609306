"""What diagnose has no name for, or refuses to name: better none than a wrong one."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import NOISE_RAD_S, applied, driven, identified, measured
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.hammerstein import HammersteinModel


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return identified()


@pytest.mark.parametrize(("reversals", "named"), [(2, False), (60, True)])
def test_a_cause_that_acts_on_a_handful_of_windows_is_not_named(
    model: HammersteinModel, reversals: int, named: bool
) -> None:
    phase_deg = 60.0 * np.sign(np.sin(np.arange(2000) * np.pi * (reversals + 0.5) / 2000.0 + 1e-6))
    found = diagnose([driven(phase_deg, 17, applied("coupling_backlash", "", gap_rad=0.1))], model)
    assert ("coupling_backlash" in [cause.name for cause in found.causes]) == named


def test_noise_that_has_grown_is_a_finding(model: HammersteinModel) -> None:
    record = measured(13)
    louder = 3.0 * NOISE_RAD_S * np.random.default_rng(14).standard_normal(record.t_s.size)
    found = diagnose([replace(record, speed_rad_s=record.speed_rad_s + louder)], model)
    assert (found.verdict, found.causes) == ("unexplained", ())
    assert found.remainder is not None
    assert found.remainder.versus == "noise"


def test_says_so_where_no_cause_fits(model: HammersteinModel) -> None:
    record = measured(9, n=700)
    # Every third second the shaft runs backwards against its commands: nothing does that.
    odd = np.where(np.floor(record.t_s) % 3 == 0, -0.4, 0.9) * record.speed_rad_s
    found = diagnose([replace(record, speed_rad_s=odd)], model)
    assert found.verdict in {"unexplained", "partly_explained"}
    assert found.remainder is not None


def test_a_hum_is_no_noise_of_a_model_that_states_its_noise(model: HammersteinModel) -> None:
    by_hand = replace(model, residual={})
    healthy = measured(3)
    assert diagnose([healthy], by_hand).verdict == "no_discrepancy"
    hum = 0.2 * np.sin(2.0 * np.pi * 7.3 * healthy.t_s)
    humming = replace(healthy, speed_rad_s=healthy.speed_rad_s + hum)
    found = diagnose([humming], by_hand)
    assert (found.verdict, found.causes) == ("unexplained", ())
