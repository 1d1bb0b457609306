"""Counts that are lost or false by chance: named, told from what takes speed alike, scattered."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import NOISE_RAD_S, applied, driven, measured, problem_of
from tests.usmbench.diagnose.naming.swallowed_counts import (
    COUNT_RAD_S,
    dwelling,
    fast_windows,
    saying,
    swallowed,
)
from usmbench.diagnose.naming.chance import leaves_scatter, scatters
from usmbench.diagnose.naming.ranking import rank, telling_deviance
from usmbench.model.applied import Applied
from usmbench.model.effects.registry import find_effect

LOST = find_effect("missed_counts", "of all")


@pytest.mark.parametrize("share", [0.003, 0.01, 0.03])
def test_whole_counts_scatter_and_a_smooth_loss_does_not(share: float) -> None:
    record = dwelling()
    top_rad_s = float(np.max(np.abs(record.speed_rad_s)))
    loss = Applied(LOST, {"share_lost": share, "above_rad_s": 0.95 * top_rad_s})
    counts = swallowed(record, share * top_rad_s / (4.0 * COUNT_RAD_S))
    for run, scattered in ((counts, True), (dwelling(loss), False)):
        assert scatters(problem_of([saying(run, 2000)]), [loss]) is scattered
        assert scatters(problem_of([run]), [loss])


def test_scatter_of_counts_far_smaller_than_the_noise_is_not_missed() -> None:
    lost = applied("missed_counts", "of all", share_lost=0.02, above_rad_s=6.0)
    for seed in range(60, 70):
        problem = problem_of([saying(measured(seed, lost), 400_000)])
        assert scatters(problem, [lost])


@pytest.mark.parametrize(
    ("share", "width_rad_s", "n_fast"),
    [(0.03, 0.3, 30), (0.03, 0.8, 30), (0.1, 0.3, 30), (0.1, 0.3, 2)],
)
def test_a_drag_at_one_speed_is_no_scatter(share: float, width_rad_s: float, n_fast: int) -> None:
    rng = np.random.default_rng(3)
    phases_deg = np.r_[rng.uniform(-30.0, 30.0, 60), rng.uniform(80.0, 88.0, n_fast)]
    record = driven(np.repeat(rng.permutation(phases_deg), 20), 13)
    size_rad_s = np.abs(record.speed_rad_s)
    top_rad_s = float(np.max(size_rad_s))
    loss = Applied(LOST, {"share_lost": share, "above_rad_s": 0.95 * top_rad_s})
    sings = np.exp(-(((size_rad_s - top_rad_s) / width_rad_s) ** 2))
    drag = replace(record, speed_rad_s=record.speed_rad_s * (1.0 - 2.0 * share * sings))
    counts = swallowed(record, share * top_rad_s / (4.0 * COUNT_RAD_S))
    for run, scattered in ((counts, True), (drag, False)):
        assert leaves_scatter(problem_of([run]), [loss]) is scattered


@pytest.mark.parametrize(
    ("scale_error", "named", "scattered"),
    [(0.05, True, True), (0.05, False, False), (0.02, False, True)],
    ids=["named", "more than another day's gain", "another day's gain"],
)
def test_what_is_named_or_no_news_is_no_scatter_against_the_loss(
    scale_error: float, *, named: bool, scattered: bool
) -> None:
    faster = applied("speed_scale", "", scale_error=scale_error)
    record = dwelling(faster)
    top_rad_s = float(np.max(np.abs(record.speed_rad_s)))
    lines = 0.12
    loss = {"share_lost": 4.0 * lines * COUNT_RAD_S / top_rad_s, "above_rad_s": 0.93 * top_rad_s}
    problem = problem_of([swallowed(record, lines)])
    effects = [Applied(LOST, loss), *([faster] if named else [])]
    assert leaves_scatter(problem, effects) == scattered


@pytest.mark.parametrize(("lost", "scattered"), [((3, 0.2), True), ((1, 0.0), False)])
def test_a_scatter_not_much_larger_than_the_noise_is_one(
    lost: tuple[int, float], scattered: bool
) -> None:
    """The noise of all the windows that nothing strikes is none."""
    record = dwelling()
    fast, sign = fast_windows(record), np.sign(record.speed_rad_s)
    off_rad_s = 4.0 * NOISE_RAD_S * np.random.default_rng(5).binomial(*lost, fast.size) * fast
    mean_rad_s = 4.0 * NOISE_RAD_S * 0.6
    at_rad_s = float(np.min(np.abs(record.speed_rad_s[fast])))
    size = {"share_lost": mean_rad_s / at_rad_s, "above_rad_s": at_rad_s}
    problem = problem_of([replace(record, speed_rad_s=record.speed_rad_s - sign * off_rad_s)])
    assert leaves_scatter(problem, [Applied(LOST, size)]) == scattered


def test_a_smooth_loss_stands_behind_what_explains_about_as_much() -> None:
    loss = Applied(LOST, {"share_lost": 0.01, "above_rad_s": 6.0})
    told, silent = (
        rank(problem_of([saying(measured(14, loss), counts)]), [LOST], 1.0)[0]
        for counts in (2000, None)
    )
    assert told.statistic == pytest.approx(silent.statistic)
    assert told.statistic > 500.0
    assert silent.score - told.score == pytest.approx(telling_deviance(told.statistic))
