"""Counts that are lost or false by chance: named, told from what takes speed alike, scattered."""

import numpy as np
import pytest

from known_motor import applied, measured
from tests.usmbench.diagnose.naming.swallowed_counts import (
    COUNT_RAD_S,
    dwelling,
    fast_windows,
    names_in,
    once_lost,
    saying,
    swallowed,
    with_counts,
)
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.hammerstein import HammersteinModel


@pytest.mark.parametrize("lines", [0.12, 0.5])
def test_counts_that_a_filter_swallows_by_chance_are_missed_counts(lines: float) -> None:
    found = once_lost(lines)
    assert found.verdict in {"explained", "partly_explained"}
    assert [cause.name for cause in found.causes] == ["missed_counts"]


@pytest.mark.parametrize("lines", [0.12, 0.5])
def test_an_extended_model_scatters_as_counts_that_are_lost_do(lines: float) -> None:
    first = once_lost(lines)
    assert first.verdict in {"explained", "partly_explained"}
    for seed in (5, 6):
        again = diagnose([saying(swallowed(dwelling(), lines, seed), 2000)], first.extended)
        assert (again.verdict, again.warnings) == ("no_discrepancy", ())


def test_of_counts_that_are_lost_by_chance_the_mean_is_found(model: HammersteinModel) -> None:
    for seed in (5, 6):
        (cause,) = diagnose([swallowed(dwelling(), 0.5, seed)], model).causes
        share = cause.parameters[0]
        assert share.low < 2.0 * COUNT_RAD_S / np.max(dwelling().speed_rad_s) < share.high


def test_what_swallowed_counts_cover_is_named_from_slower_windows(model: HammersteinModel) -> None:
    record = dwelling(applied("phase_offset", "", offset_deg=0.5))
    found = [diagnose([swallowed(record, 0.5, seed)], model).causes for seed in range(5, 8)]
    named = [causes for causes in found if causes]
    assert len(named) >= 2  # chance decides whether the counts are found beside the offset
    for causes in named:
        assert [cause.name for cause in causes] == ["missed_counts", "phase_offset"]
        (found_deg,) = causes[1].parameters
        assert found_deg.value == pytest.approx(0.5, rel=0.05)


@pytest.mark.parametrize(
    ("counts_per_rev", "causes"),
    [(2000, ["count_glitches"]), (None, ["count_glitches"]), (200, [])],
)
def test_false_counts_stand_out_soon_after_a_jump_by_a_good_part_of_a_count(
    model: HammersteinModel, counts_per_rev: int | None, causes: list[str]
) -> None:
    record = saying(measured(21), counts_per_rev)
    runs_on = np.arange(record.t_s.size) % 5 == 3
    rows = np.flatnonzero(runs_on & (np.abs(record.speed_rad_s) > 3.0))[::25]
    false = np.zeros(runs_on.size)
    false[rows] = 1.5 * np.where(np.arange(rows.size) % 2, 1.0, -1.0)
    assert names_in(with_counts(record, false), model) == causes


@pytest.mark.parametrize(
    ("offset_deg", "causes"),
    [(0.1, ["count_glitches", "phase_offset"]), (2.0, ["phase_offset", "count_glitches"])],
)
def test_false_counts_come_first_where_they_bring_more(
    model: HammersteinModel, offset_deg: float, causes: list[str]
) -> None:
    record = dwelling(applied("phase_offset", "", offset_deg=offset_deg))
    n, rng = record.t_s.size, np.random.default_rng(3)
    false = 3.0 * rng.choice([-1.0, 1.0], n) * (rng.uniform(size=n) < 0.02)
    assert names_in(with_counts(record, false), model) == causes


def test_counts_that_are_lost_more_often_than_an_extended_model_says_are_named() -> None:
    often = saying(swallowed(dwelling(), 0.7, 7), 2000)
    assert names_in(often, once_lost(0.12).extended) == ["missed_counts"]


def test_a_small_scale_is_named_beside_lost_counts_that_explain_far_more(
    model: HammersteinModel,
) -> None:
    """These say nothing where none are lost."""
    slower = applied("speed_scale", "", scale_error=0.003)
    names = names_in(swallowed(dwelling(slower), 0.5), model)
    assert names == ["missed_counts", "speed_scale"]


def test_false_counts_are_named_from_windows_too_slow_to_swallow_any(
    model: HammersteinModel,
) -> None:
    record, rng = swallowed(dwelling(), 0.5), np.random.default_rng(3)
    n = record.t_s.size
    false = rng.choice([-1.0, 1.0], n) * (rng.uniform(size=n) < 0.02)
    assert names_in(with_counts(record, false), model) == ["missed_counts", "count_glitches"]


def test_scatter_at_high_speed_that_is_no_loss_has_no_name(model: HammersteinModel) -> None:
    record = measured(13)
    shaken = 4.0 * np.random.default_rng(4).standard_normal(record.t_s.size) * fast_windows(record)
    assert diagnose([with_counts(record, shaken)], model).verdict == "unexplained"
