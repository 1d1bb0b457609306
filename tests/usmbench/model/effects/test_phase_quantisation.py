"""Grids of phases: what they do, and the steps that are tried."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.model.applied import Applied
from usmbench.model.effects.context import Context
from usmbench.model.effects.phase_offset import PhaseOffset
from usmbench.model.effects.phase_quantisation import (
    PhaseCutToZero,
    RoundedPhase,
    TruncatedPhase,
)
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import LinearPart

Array = NDArray[np.float64]
WINDOW_S = 0.01
LINEAR = LinearPart(np.array([-0.05]), np.array([0.6, 0.35]), 0, WINDOW_S)


def _context(n: int) -> Context:
    return Context(WINDOW_S * np.arange(1.0, n + 1.0), WINDOW_S, np.zeros(n), lambda p: p, LINEAR)


def test_a_register_rounds_or_cuts_off() -> None:
    phase_deg = np.array([-7.4, 0.4, 3.9, 11.0])
    rounded = RoundedPhase().apply(phase_deg, _context(4), {"step_deg": 4.0})
    cut = TruncatedPhase().apply(phase_deg, _context(4), {"step_deg": 4.0})
    assert np.allclose(rounded, [-8.0, 0.0, 4.0, 12.0])
    assert np.allclose(cut, [-8.0, 0.0, 0.0, 8.0])
    to_zero = PhaseCutToZero().apply(np.r_[phase_deg, -8.0], _context(5), {"step_deg": 4.0})
    assert np.allclose(to_zero, [-4.0, 0.0, 0.0, 8.0, -8.0])


@pytest.mark.parametrize("farthest_deg", [47.3, 90.0, 178.9])
def test_steps_are_tried_close_enough_to_meet_a_coarse_one(farthest_deg: float) -> None:
    phase_deg = np.linspace(-farthest_deg, farthest_deg, 101)
    (steps_deg,) = RoundedPhase().grid([replace(_context(101), phase_deg=phase_deg)]).values()
    levels = farthest_deg / steps_deg[steps_deg <= farthest_deg]
    assert np.max(-np.diff(levels[levels < farthest_deg / 10.0])) <= 0.25 + 1e-9
    assert np.max(-np.diff(levels[levels < farthest_deg / 0.4])) <= 0.5 + 1e-9


def test_a_long_run_has_no_time_for_the_finest_steps() -> None:
    phase_deg = np.random.default_rng(1).uniform(-90.0, 90.0, 10_001)
    context = replace(_context(phase_deg.size), phase_deg=phase_deg)
    few, many = (
        np.count_nonzero(RoundedPhase().grid(contexts)["step_deg"] < 0.69)
        for contexts in ([context], [context, context])
    )
    assert few > 200
    assert many < 15


@pytest.mark.parametrize(
    ("count_rad_s", "finest_deg"), [(None, 0.35), (0.1, 0.35), (0.4, 0.6), (5.0, 0.7)]
)
def test_a_step_worth_no_more_than_a_count_is_lost_among_whole_counts(
    count_rad_s: float | None, finest_deg: float
) -> None:
    """The curve of the context rises by 1 rad/s a degree."""
    phase_deg = np.random.default_rng(1).uniform(-90.0, 90.0, 2000)
    context = replace(_context(2000), phase_deg=phase_deg, count_rad_s=count_rad_s)
    (steps_deg,) = RoundedPhase().grid([context]).values()
    assert np.count_nonzero(steps_deg < finest_deg - 0.01) < 10
    assert np.count_nonzero(steps_deg < finest_deg + 0.02) > 10


def test_what_shifts_the_voltages_acts_behind_the_register() -> None:
    context = replace(_context(50), phase_deg=np.linspace(-40.0, 40.0, 50))
    rounded = Applied(RoundedPhase(), {"step_deg": 5.0})
    late = Applied(PhaseOffset(), {"offset_deg": 2.4})
    runs = [
        extended_run(order, context).speed_rad_s for order in ((rounded, late), (late, rounded))
    ]
    grid_deg = 5.0 * np.rint(context.phase_deg / 5.0)
    truth = extended_run((), replace(context, phase_deg=grid_deg + 2.4)).speed_rad_s
    assert np.array_equal(runs[0], truth)
    assert np.array_equal(runs[1], truth)


@pytest.mark.parametrize("levels", [13, 31])
def test_where_phases_are_few_no_step_is_tried_that_a_smooth_shape_stands_in_for(
    levels: int,
) -> None:
    apart_deg = 180.0 / (levels - 1)
    few = replace(_context(levels), phase_deg=np.linspace(-90.0, 90.0, levels))
    (tried_deg,) = RoundedPhase().grid([few]).values()
    (one_deg,) = RoundedPhase().grid([replace(few, phase_deg=np.full(levels, 5.0))]).values()
    usual = np.isin(tried_deg, one_deg)
    assert np.array_equal(tried_deg[usual], one_deg)
    assert np.max(-np.diff(90.0 / tried_deg[tried_deg >= apart_deg])) <= 0.5 + 1e-9
    fine_deg = tried_deg[~usual & (tried_deg < apart_deg)]
    # From one level to the next by so much of a step more or less than a whole one.
    beside = np.abs(apart_deg / fine_deg - np.rint(apart_deg / fine_deg))
    if levels == 13:
        assert fine_deg.size == 0
    else:
        assert np.min(beside) > 0.1
        assert np.sum(beside > 0.4) > 30
