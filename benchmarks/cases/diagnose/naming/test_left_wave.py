"""What is left swings in a wave, or has no pattern."""

import re
from dataclasses import replace

import numpy as np
import pytest

from known_motor import NOISE_RAD_S, measured
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.hammerstein import HammersteinModel


def test_a_hum_is_told_with_its_frequency_as_the_windows_see_it(
    model: HammersteinModel,
) -> None:
    record = measured(13)
    hum_rad_s = 6.0 * NOISE_RAD_S * np.sin(2.0 * np.pi * 104.06 * record.t_s)
    found = diagnose([replace(record, speed_rad_s=record.speed_rad_s + hum_rad_s)], model)
    assert found.verdict == "unexplained"
    assert found.remainder is not None
    said = re.search(r"a wave of ([\d.]+) Hz", found.remainder.says)
    assert said is not None
    assert float(said[1]) == pytest.approx(4.06, abs=0.02)
