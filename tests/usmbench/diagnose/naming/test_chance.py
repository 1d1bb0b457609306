"""Counts that are lost or false by chance: named, told from what takes speed alike, scattered."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from known_motor import NOISE_RAD_S, WINDOW_S, applied, driven, identified, measured
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.naming.chance import leaves_scatter, scatters
from usmbench.diagnose.naming.ranking import rank, telling_deviance
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.result import Diagnosis
from usmbench.model.applied import Applied
from usmbench.model.effects.registry import find_effect
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record

COUNT_RAD_S = 2.0 * np.pi / 2000.0 / WINDOW_S
LOST = find_effect("missed_counts", "of all")


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return identified()


def _dwelling(*effects: Applied) -> Record:
    """Return a run that stays at each of a hundred phases."""
    phases_deg = np.random.default_rng(3).uniform(-88.0, 88.0, 100)
    return driven(np.repeat(phases_deg, 20), 13, *effects)


def _fast(record: Record) -> NDArray[np.bool_]:
    """Windows near the highest speed."""
    size = np.abs(record.speed_rad_s)
    fast: NDArray[np.bool_] = size > 0.95 * np.max(size)
    return fast


def _swallowed(record: Record, lines: float, seed: int = 5) -> Record:
    """Return the run with so many of seven lines swallowed in the mean, where it is fast."""
    fast = _fast(record)
    counts = 4.0 * np.random.default_rng(seed).binomial(7, lines / 7.0, fast.size) * fast
    return _counted(record, -np.sign(record.speed_rad_s) * counts)


def _counted(record: Record, counts: NDArray[np.float64]) -> Record:
    return replace(record, speed_rad_s=record.speed_rad_s + COUNT_RAD_S * counts)


def _saying(record: Record, counts_per_rev: int | None) -> Record:
    return replace(record, meta={"encoder": {"counts_per_rev": counts_per_rev}})


@cache
def _once_lost(lines: float) -> Diagnosis:
    """Return what is said of a run that so many lines are lost of, of a counter that says so."""
    return diagnose([_saying(_swallowed(_dwelling(), lines), 2000)], identified())


def _names(record: Record, model: HammersteinModel) -> list[str]:
    return [cause.name for cause in diagnose([record], model).causes]


def _problem(record: Record, model: HammersteinModel) -> Problem:
    known, (stretches, _) = knowledge_of(model), cut_runs([record], model, ())
    assert known.noise is not None
    return Problem(stretches, known, known.noise, [s.use for s in stretches])


@pytest.mark.parametrize("lines", [0.12, 0.5])
def test_counts_that_a_filter_swallows_by_chance_are_missed_counts(lines: float) -> None:
    found = _once_lost(lines)
    assert found.verdict in {"explained", "partly_explained"}
    assert [cause.name for cause in found.causes] == ["missed_counts"]


@pytest.mark.parametrize("lines", [0.12, 0.5])
def test_an_extended_model_scatters_as_counts_that_are_lost_do(lines: float) -> None:
    first = _once_lost(lines)
    assert first.verdict in {"explained", "partly_explained"}
    for seed in (5, 6):
        again = diagnose([_saying(_swallowed(_dwelling(), lines, seed), 2000)], first.extended)
        assert (again.verdict, again.warnings) == ("no_discrepancy", ())


def test_counts_that_are_lost_more_often_than_an_extended_model_says_are_named() -> None:
    often = _saying(_swallowed(_dwelling(), 0.7, 7), 2000)
    assert _names(often, _once_lost(0.12).extended) == ["missed_counts"]


def test_of_counts_that_are_lost_by_chance_the_mean_is_found(model: HammersteinModel) -> None:
    for seed in (5, 6):
        (cause,) = diagnose([_swallowed(_dwelling(), 0.5, seed)], model).causes
        share = cause.parameters[0]
        assert share.low < 2.0 * COUNT_RAD_S / np.max(_dwelling().speed_rad_s) < share.high


def test_what_swallowed_counts_cover_is_named_from_slower_windows(model: HammersteinModel) -> None:
    record = _dwelling(applied("phase_offset", "", offset_deg=0.5))
    found = [diagnose([_swallowed(record, 0.5, seed)], model).causes for seed in range(5, 8)]
    named = [causes for causes in found if causes]
    assert len(named) >= 2  # chance decides whether the counts are found beside the offset
    for causes in named:
        assert [cause.name for cause in causes] == ["missed_counts", "phase_offset"]
        (found_deg,) = causes[1].parameters
        assert found_deg.value == pytest.approx(0.5, rel=0.05)


def test_false_counts_are_named_from_windows_too_slow_to_swallow_any(
    model: HammersteinModel,
) -> None:
    record, rng = _swallowed(_dwelling(), 0.5), np.random.default_rng(3)
    n = record.t_s.size
    false = rng.choice([-1.0, 1.0], n) * (rng.uniform(size=n) < 0.02)
    assert _names(_counted(record, false), model) == ["missed_counts", "count_glitches"]


@pytest.mark.parametrize(
    ("counts_per_rev", "causes"),
    [(2000, ["count_glitches"]), (None, ["count_glitches"]), (200, [])],
)
def test_false_counts_stand_out_soon_after_a_jump_by_a_good_part_of_a_count(
    model: HammersteinModel, counts_per_rev: int | None, causes: list[str]
) -> None:
    record = _saying(measured(21), counts_per_rev)
    runs_on = np.arange(record.t_s.size) % 5 == 3
    rows = np.flatnonzero(runs_on & (np.abs(record.speed_rad_s) > 3.0))[::25]
    false = np.zeros(runs_on.size)
    false[rows] = 1.5 * np.where(np.arange(rows.size) % 2, 1.0, -1.0)
    assert _names(_counted(record, false), model) == causes


@pytest.mark.parametrize(
    ("offset_deg", "causes"),
    [(0.1, ["count_glitches", "phase_offset"]), (2.0, ["phase_offset", "count_glitches"])],
)
def test_false_counts_come_first_where_they_bring_more(
    model: HammersteinModel, offset_deg: float, causes: list[str]
) -> None:
    record = _dwelling(applied("phase_offset", "", offset_deg=offset_deg))
    n, rng = record.t_s.size, np.random.default_rng(3)
    false = 3.0 * rng.choice([-1.0, 1.0], n) * (rng.uniform(size=n) < 0.02)
    assert _names(_counted(record, false), model) == causes


def test_scatter_at_high_speed_that_is_no_loss_has_no_name(model: HammersteinModel) -> None:
    record = measured(13)
    shaken = 4.0 * np.random.default_rng(4).standard_normal(record.t_s.size) * _fast(record)
    assert diagnose([_counted(record, shaken)], model).verdict == "unexplained"


@pytest.mark.parametrize("share", [0.003, 0.01, 0.03])
def test_whole_counts_scatter_and_a_smooth_loss_does_not(
    model: HammersteinModel, share: float
) -> None:
    record = _dwelling()
    top_rad_s = float(np.max(np.abs(record.speed_rad_s)))
    loss = Applied(LOST, {"share_lost": share, "above_rad_s": 0.95 * top_rad_s})
    counts = _swallowed(record, share * top_rad_s / (4.0 * COUNT_RAD_S))
    for run, scattered in ((counts, True), (_dwelling(loss), False)):
        assert scatters(_problem(_saying(run, 2000), model), [loss]) is scattered
        assert scatters(_problem(run, model), [loss])


@pytest.mark.parametrize(
    ("share", "width_rad_s", "n_fast"),
    [(0.03, 0.3, 30), (0.03, 0.8, 30), (0.1, 0.3, 30), (0.1, 0.3, 2)],
)
def test_a_drag_at_one_speed_is_no_scatter(
    model: HammersteinModel, share: float, width_rad_s: float, n_fast: int
) -> None:
    rng = np.random.default_rng(3)
    phases_deg = np.r_[rng.uniform(-30.0, 30.0, 60), rng.uniform(80.0, 88.0, n_fast)]
    record = driven(np.repeat(rng.permutation(phases_deg), 20), 13)
    size_rad_s = np.abs(record.speed_rad_s)
    top_rad_s = float(np.max(size_rad_s))
    loss = Applied(LOST, {"share_lost": share, "above_rad_s": 0.95 * top_rad_s})
    sings = np.exp(-(((size_rad_s - top_rad_s) / width_rad_s) ** 2))
    drag = replace(record, speed_rad_s=record.speed_rad_s * (1.0 - 2.0 * share * sings))
    counts = _swallowed(record, share * top_rad_s / (4.0 * COUNT_RAD_S))
    for run, scattered in ((counts, True), (drag, False)):
        assert leaves_scatter(_problem(run, model), [loss]) is scattered


def test_a_small_scale_is_named_beside_lost_counts_that_explain_far_more(
    model: HammersteinModel,
) -> None:
    """These say nothing where none are lost."""
    slower = applied("speed_scale", "", scale_error=0.003)
    names = _names(_swallowed(_dwelling(slower), 0.5), model)
    assert names == ["missed_counts", "speed_scale"]


@pytest.mark.parametrize(
    ("scale_error", "named", "scattered"),
    [(0.05, True, True), (0.05, False, False), (0.02, False, True)],
    ids=["named", "more than another day's gain", "another day's gain"],
)
def test_what_is_named_or_no_news_is_no_scatter_against_the_loss(
    model: HammersteinModel, scale_error: float, *, named: bool, scattered: bool
) -> None:
    faster = applied("speed_scale", "", scale_error=scale_error)
    record = _dwelling(faster)
    top_rad_s = float(np.max(np.abs(record.speed_rad_s)))
    lines = 0.12
    loss = {"share_lost": 4.0 * lines * COUNT_RAD_S / top_rad_s, "above_rad_s": 0.93 * top_rad_s}
    problem = _problem(_swallowed(record, lines), model)
    effects = [Applied(LOST, loss), *([faster] if named else [])]
    assert leaves_scatter(problem, effects) == scattered


@pytest.mark.parametrize(("lost", "scattered"), [((3, 0.2), True), ((1, 0.0), False)])
def test_a_scatter_not_much_larger_than_the_noise_is_one(
    model: HammersteinModel, lost: tuple[int, float], scattered: bool
) -> None:
    """The noise of all the windows that nothing strikes is none."""
    record = _dwelling()
    fast, sign = _fast(record), np.sign(record.speed_rad_s)
    off_rad_s = 4.0 * NOISE_RAD_S * np.random.default_rng(5).binomial(*lost, fast.size) * fast
    mean_rad_s = 4.0 * NOISE_RAD_S * 0.6
    at_rad_s = float(np.min(np.abs(record.speed_rad_s[fast])))
    size = {"share_lost": mean_rad_s / at_rad_s, "above_rad_s": at_rad_s}
    problem = _problem(replace(record, speed_rad_s=record.speed_rad_s - sign * off_rad_s), model)
    assert leaves_scatter(problem, [Applied(LOST, size)]) == scattered


def test_a_smooth_loss_stands_behind_what_explains_about_as_much(model: HammersteinModel) -> None:
    loss = Applied(LOST, {"share_lost": 0.01, "above_rad_s": 6.0})
    saying, silent = (
        rank(_problem(_saying(measured(14, loss), counts), model), [LOST], 1.0)[0]
        for counts in (2000, None)
    )
    assert saying.statistic == pytest.approx(silent.statistic)
    assert saying.statistic > 500.0
    assert silent.score - saying.score == pytest.approx(telling_deviance(saying.statistic))
