"""Windows that stand alone, and what they are beside an effect that is large there."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import NOISE_RAD_S, driven, identified, measured
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.hammerstein import HammersteinModel


@pytest.mark.parametrize("times_noise", [12.0, 0.0])
def test_a_day_of_another_gain_hides_no_lone_windows(
    wandering: HammersteinModel, times_noise: float
) -> None:
    record = measured(11, n=4000)
    off = np.zeros(record.speed_rad_s.size)
    off[54::400] = times_noise * NOISE_RAD_S
    faster = 1.01 * record.speed_rad_s
    found = diagnose([replace(record, speed_rad_s=faster + off)], wandering)
    assert [cause.name for cause in found.causes] == ["count_glitches"] * (times_noise > 0.0)


@pytest.fixture(scope="module")
def wandering() -> HammersteinModel:
    """Return the model of a motor whose gain is another each day."""
    days = {1: -0.01, 2: 0.008, 101: 0.004, 102: -0.003}
    runs = [
        replace(run, speed_rad_s=(1.0 + days[seed]) * run.speed_rad_s)
        for seed, run in ((seed, measured(seed)) for seed in days)
    ]
    return with_knowledge(identify_fast(runs, FastOptions(12)).model, runs)


@pytest.mark.parametrize(("times_noise", "most"), [(40.0, True), (12.0, False)])
def test_where_something_has_no_name_lone_windows_are_told_too(
    times_noise: float, *, most: bool
) -> None:
    model, record = identified(), measured(25)
    slower = 0.2 * np.exp(-((np.abs(record.speed_rad_s) - 5.0) ** 2)) * np.sign(record.speed_rad_s)
    off = np.zeros(record.speed_rad_s.size)
    off[502::100] = times_noise * NOISE_RAD_S
    found = diagnose([replace(record, speed_rad_s=record.speed_rad_s - slower + off)], model)
    names = [cause.name for cause in found.causes]
    told = bool([w for w in found.warnings if "stand alone" in w])
    assert (found.verdict, names, told) == (
        ("partly_explained", ["count_glitches"], False) if most else ("unexplained", [], True)
    )


@pytest.mark.parametrize("seed", range(2))
def test_false_counts_may_strike_mostly_where_the_motor_moves(seed: int) -> None:
    rows = np.arange(2000)
    phase_deg = 80.0 * np.sin(2.0 * np.pi * rows / 47.3)
    record, rng = driven(phase_deg, 6), np.random.default_rng(seed)
    off = 20.0 * NOISE_RAD_S * rng.choice([-1.0, 1.0], rows.size) * (rng.random(rows.size) < 0.02)
    found = diagnose([replace(record, speed_rad_s=record.speed_rad_s + off)], identified())
    assert (found.verdict, [cause.name for cause in found.causes]) == (
        "explained",
        ["count_glitches"],
    )
