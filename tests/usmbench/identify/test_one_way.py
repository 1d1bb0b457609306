"""Runs of which one counts the other way are no runs of one motor."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from usmbench.errors import InputError
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.gather import from_pairs
from usmbench.identify.one_way import check_one_way
from usmbench.runs.record import Record

Measure = Callable[..., Record]


@pytest.mark.parametrize("turned", ["speed_rad_s", "phase_deg"])
def test_the_run_that_turns_the_other_way_is_named(measure: Measure, turned: str) -> None:
    runs = [measure(800, seed=seed) for seed in (1, 2, 3)]
    runs[1] = replace(runs[1], **{turned: -getattr(runs[1], turned)})
    with pytest.raises(
        InputError, match=r"^run 2: of the other direction .* than run 1 and run 3; "
    ):
        identify_fast(runs, FastOptions())
    with pytest.raises(InputError, match=r"^run 2: "):
        from_pairs(runs)


def test_runs_that_all_turn_the_other_way_belong_together(measure: Measure) -> None:
    check_one_way([measure(800, seed=seed, gain=-1.0) for seed in (1, 2)])


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_run_of_one_direction_belongs_to_one_of_both(measure: Measure, side: float) -> None:
    both = measure(800, seed=1)
    check_one_way([both, both.rows(side * both.phase_deg >= 0.0)])


def test_neither_a_wild_row_nor_what_was_not_driven_says_which_way(measure: Measure) -> None:
    run, other = measure(800, seed=1), measure(800, seed=2, gain=-1.0)
    other.speed_rad_s[10] = 1e6
    with pytest.raises(InputError, match=r"^run 1: of the other direction"):
        check_one_way([run, other])
    coasting = np.arange(800) < 700
    speed_rad_s = np.where(coasting, -run.speed_rad_s, run.speed_rad_s)
    driven = replace(run, speed_rad_s=speed_rad_s, extra={"drive_on": np.where(coasting, 0.0, 1.0)})
    check_one_way([run, driven])
