"""Counts that are lost by chance, more the faster the motor turns."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import WINDOW_S, driven, identified
from usmbench.diagnose.pipeline import diagnose

COUNT_RAD_S = 2.0 * np.pi / 20_000.0 / WINDOW_S


def test_counts_of_pulses_of_many_widths_are_named_with_share_and_speed() -> None:
    """Whole counts, by chance, more of them the faster the motor turns."""
    run = driven(np.repeat(np.random.default_rng(3).uniform(-88.0, 88.0, 100), 20), 13)
    size_rad_s, sign = np.abs(run.speed_rad_s), np.sign(run.speed_rad_s)
    share_lost = 0.08
    share = share_lost * (1.0 - np.exp(-np.maximum(size_rad_s - 6.0, 0.0) / 1.5))
    counts = np.round(size_rad_s / COUNT_RAD_S).astype(int)
    lost = np.random.default_rng(5).binomial(counts, share)
    record = replace(run, speed_rad_s=run.speed_rad_s - sign * lost * COUNT_RAD_S)
    found = diagnose([record], identified())
    (cause,) = found.causes
    values = {p.name: p.value for p in cause.parameters}
    assert (found.verdict, cause.name) == ("explained", "missed_counts")
    assert values["share_lost"] == pytest.approx(share_lost, rel=0.2)
    assert values["above_rad_s"] == pytest.approx(6.0, abs=0.3)
