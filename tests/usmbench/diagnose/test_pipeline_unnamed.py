"""What diagnose has no name for, or refuses to name: better none than a wrong one."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import NOISE_RAD_S, identified, measured
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.hammerstein import HammersteinModel


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return identified()


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
