"""Windows that stand alone, and what they are beside an effect that is large there."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import sawtooth

from known_motor import (
    CURVE,
    NOISE_RAD_S,
    WINDOW_S,
    applied,
    driven,
    identified,
    measured,
    problem_of,
)
from tests.usmbench.diagnose.gapped_runs import (
    found_in,
    gapped_run,
    knowing,
    with_false_counts,
    without,
)
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.naming.sporadic import find_sporadic
from usmbench.diagnose.naming.unnamed_windows import left_unnamed
from usmbench.diagnose.noise.rotor_states import whole_count_rad_s
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.model.replay import replay_record
from usmbench.runs.record import Record

Array = NDArray[np.int64]


@pytest.mark.parametrize(("scale_error", "found"), [(0.01, True), (0.3, False)])
def test_what_an_effect_may_be_off_by_is_no_false_count(scale_error: float, found: bool) -> None:
    effect = applied("speed_scale", "", scale_error=scale_error)
    phase_deg = np.repeat(np.random.default_rng(2).uniform(30.0, 88.0, 100), 20)
    record = driven(phase_deg, 4, effect)
    off = np.zeros(phase_deg.size)
    off[210::200] = 25.0 * NOISE_RAD_S
    problem = problem_of([replace(record, speed_rad_s=record.speed_rad_s + off)])
    sporadic = find_sporadic(problem, [effect], 1.0)
    assert (sporadic is not None) == found


@pytest.mark.parametrize("times_noise", [15.0, 60.0])
@pytest.mark.parametrize(("windows", "found"), [((6, 7, 8, 9), True), ((18, 19, 38, 39), False)])
def test_what_an_effect_does_may_come_a_window_sooner(
    windows: tuple[int, ...], found: bool, times_noise: float
) -> None:
    effect = applied("phase_quantisation", "rounded", step_deg=30.0)
    hits = np.arange(400, 2000, 400) + windows
    problem = two_phases(hits, times_noise, effect)
    assert (find_sporadic(problem, [effect], 1.0) is not None) == found


@pytest.mark.parametrize("always_there", [True, False])
def test_what_comes_back_with_the_plan_is_no_chance(always_there: bool) -> None:
    hits = np.arange(410, 2000, 400)
    problem = two_phases(hits if always_there else hits + hits // 400, 15.0)
    assert (find_sporadic(problem, (), 1.0) is None) == always_there


def two_phases(hits: Array, times_noise: float, *effects: Applied) -> Problem:
    """Return a run to and fro between two phases, some of its windows off by some noise."""
    phase_deg = np.tile(np.repeat([30.0, 44.0], 20), 50)  # on a grid of 30 degrees, and beside it
    record = driven(phase_deg, 4, *effects)
    speed_rad_s = record.speed_rad_s.copy()
    speed_rad_s[hits] += times_noise * NOISE_RAD_S
    return problem_of([replace(record, speed_rad_s=speed_rad_s)])


@pytest.mark.parametrize("by_chance", [True, False])
def test_what_hangs_on_the_phase_is_no_chance(by_chance: bool) -> None:
    phase_deg = 85.0 * sawtooth(0.1 * np.arange(4000.0), 0.5)
    record = driven(phase_deg, 4)
    band = (phase_deg > 41.0) & (phase_deg < 44.0)
    struck = np.random.default_rng(3).permutation(band) if by_chance else band
    speed_rad_s = record.speed_rad_s - np.where(struck, 20.0 * NOISE_RAD_S, 0.0)
    problem = problem_of([replace(record, speed_rad_s=speed_rad_s)])
    assert (find_sporadic(problem, (), 1.0) is not None) == by_chance


@pytest.mark.parametrize(("slow_ones", "found"), [(False, True), (True, False)])
def test_a_counter_errs_no_more_often_the_slower_it_counts(slow_ones: bool, found: bool) -> None:
    phase_deg = np.repeat(np.random.default_rng(7).uniform(15.0, 88.0, 200), 20)
    record = driven(phase_deg, 4)
    holds = np.flatnonzero(phase_deg[::20] < 33.0) if slow_ones else np.arange(0, 200, 4)
    off = np.zeros(phase_deg.size)
    off[20 * holds[::2] + 13] = 25.0 * NOISE_RAD_S
    problem = problem_of([replace(record, speed_rad_s=record.speed_rad_s + off)])
    assert (find_sporadic(problem, (), 1.0) is not None) == found


@pytest.mark.parametrize(("after", "found"), [(0, False), (9, True)])
def test_a_false_count_does_not_wait_for_a_step(after: int, found: bool) -> None:
    """A motor that lags otherwise than the model says errs where the phase steps."""
    draw = np.random.default_rng(7)
    phases_deg = np.where(np.arange(200) % 20 < 10, 30.0, 40.0) + draw.uniform(0.0, 2.0, 200)
    record = driven(np.repeat(phases_deg, 20), 4)
    hits = 20 * np.arange(10, 200, 10) + after
    speed_rad_s = record.speed_rad_s.copy()
    speed_rad_s[hits] += 60.0 * NOISE_RAD_S * draw.choice([-1.0, 1.0], hits.size)
    problem = problem_of([replace(record, speed_rad_s=speed_rad_s)])
    assert (find_sporadic(problem, (), 1.0) is not None) == found


@pytest.mark.parametrize("one_place", [True, False])
def test_windows_that_stand_alone_at_one_angle_are_a_damaged_disc(one_place: bool) -> None:
    draw = np.random.default_rng(11)
    record = driven(np.repeat(draw.uniform(20.0, 88.0, 200), 20), 4)
    turned_rad = np.cumsum(record.speed_rad_s) * WINDOW_S
    passed = np.diff(np.floor((turned_rad - 2.0) / (2.0 * np.pi)), prepend=-1.0) > 0.0
    struck = passed if one_place else draw.permutation(passed)
    speed_rad_s = record.speed_rad_s - np.where(struck, 40.0 * NOISE_RAD_S, 0.0)
    sporadic = find_sporadic(problem_of([replace(record, speed_rad_s=speed_rad_s)]), (), 1.0)
    assert sporadic is not None
    assert (sporadic.named.name == "damaged_disc") == one_place
    assert "damaged_disc" not in sporadic.named.alternatives
    if one_place:
        assert sporadic.named.alternatives == ()
        values = sporadic.applied.values
        assert values["missing_rad"] == pytest.approx(0.4 * NOISE_RAD_S, rel=0.1)
        assert values["angle_rad"] == pytest.approx(2.0, abs=0.06)


def test_a_gap_of_the_disc_that_the_model_has_is_no_news_until_it_has_grown() -> None:
    known = found_in(gapped_run(12, (2.0, 0.05))).applied
    # By a counter that begins anew it is elsewhere, and a faster plan passes it more often.
    same, grown = (found_in(gapped_run(13, (4.0, width)), known) for width in (0.05, 0.1))
    assert (same.named.name, same.is_news, same.deviance) == ("damaged_disc", False, 0.0)
    assert (grown.named.name, grown.is_news) == ("damaged_disc", True)
    assert grown.deviance > 0.0
    other = found_in(with_false_counts(gapped_run(13), 40.0 * NOISE_RAD_S, 100), known)
    assert (other.named.name, other.is_news) == ("count_glitches", True)
    # What is left out does not count.
    assert (other.named.by_chance, grown.named.by_chance) == (True, False)


def test_a_second_gap_of_the_disc_is_found_without_the_first() -> None:
    problem = problem_of([gapped_run(12, (2.0, 0.05), (4.5, 0.1))])
    first = find_sporadic(problem, (), 1.0)
    assert first is not None
    second = find_sporadic(without(problem, first), (), 1.0, [first])
    assert second is not None
    assert [first.named.name, second.named.name] == ["damaged_disc"] * 2
    missing_rad = sorted(s.applied.values["missing_rad"] for s in (first, second))
    assert missing_rad == pytest.approx([0.05, 0.1], rel=0.05)
    third = find_sporadic(without(without(problem, first), second), (), 1.0, [first, second])
    assert third is None


@pytest.mark.parametrize(
    ("times", "every", "news"), [(1.0, 100, False), (3.0, 100, True), (1.0, 25, True)]
)
def test_false_counts_that_the_model_has_are_news_if_larger_or_more(
    times: float, every: int, *, news: bool
) -> None:
    size_rad_s = 40.0 * NOISE_RAD_S
    known = found_in(with_false_counts(gapped_run(12), size_rad_s, 100)).applied
    record = with_false_counts(gapped_run(13), times * size_rad_s, every)
    found = find_sporadic(knowing(problem_of([record]), known), (), 1.0)
    assert (found is not None) == news
    if found is not None:
        assert (found.named.name, found.is_news) == ("count_glitches", True)


def test_a_false_count_is_as_large_as_it_is_beside_its_neighbours() -> None:
    draw = np.random.default_rng(6)
    phase_deg = np.repeat(draw.uniform(30.0, 88.0, 100), 20)
    record = driven(phase_deg, 4)
    count_rad_s = 30.0 * NOISE_RAD_S
    # What a hold's speed lacks to the whole count below or above.
    part = np.repeat(draw.uniform(-0.4, 0.4, 100), 20) * count_rad_s
    off = np.zeros(phase_deg.size)
    off[13::20] = count_rad_s
    measured = replace(record, speed_rad_s=record.speed_rad_s + part + off)
    problem = problem_of([measured])
    sporadic = find_sporadic(problem, (), 1.0)
    assert sporadic is not None
    (size,) = [e for e in sporadic.named.parameters if e.name == "size_rad_s"]
    assert size.low < count_rad_s < size.high
    assert size.value == pytest.approx(count_rad_s, rel=0.02)


@pytest.mark.parametrize(("n_off", "told"), [(1, False), (2, True), (12, False)])
def test_windows_too_few_for_a_cause_are_not_left_unsaid(n_off: int, told: bool) -> None:
    phase_deg = np.repeat(np.random.default_rng(2).uniform(30.0, 88.0, 40), 20)
    record = driven(phase_deg, 4)
    off = np.zeros(phase_deg.size)
    off[15 : 15 + 60 * n_off : 60] = 25.0 * NOISE_RAD_S
    found = diagnose([replace(record, speed_rad_s=record.speed_rad_s + off)], identified())
    assert [cause.name for cause in found.causes] == (["count_glitches"] if n_off > 2 else [])
    warned = [w for w in found.warnings if "stand alone" in w]
    assert len(warned) == told
    if told:
        assert f"not judged: 2, off by up to {25.0 * NOISE_RAD_S:.1g}" in warned[0]


@pytest.mark.parametrize(
    ("spread", "above_rad_s", "told"),
    [(1.0, None, True), (1.0, 9.9, True), (1.0, 1.0, False), (4.0, None, False)],
    ids=["alone", "a loss elsewhere", "a loss there", "noise that has grown"],
)
def test_windows_that_stand_alone_have_no_cause_unless_a_loss_strikes_there_or_noise_has_grown(
    spread: float, above_rad_s: float | None, *, told: bool
) -> None:
    model = identified()
    phase_deg = np.repeat(np.random.default_rng(2).uniform(30.0, 88.0, 40), 20)
    record = driven(phase_deg, 4)
    off = np.zeros(phase_deg.size)
    off[[15, 75]] = 25.0 * NOISE_RAD_S
    (stretch,), _ = cut_runs([replace(record, speed_rad_s=record.speed_rad_s + off)], model, ())
    known = knowledge_of(model)
    assert known.noise is not None
    problem = Problem([stretch], known, known.noise, [stretch.use & (np.abs(off) == 0.0)])
    lost = applied("missed_counts", "of all", share_lost=0.02, above_rad_s=above_rad_s or 0.0)
    effects = () if above_rad_s is None else (lost,)
    assert bool(left_unnamed(problem, effects, spread)) == told


@pytest.mark.parametrize(
    ("known_well", "share_missed", "found"),
    [(True, 0.0, True), (False, 0.0, True), (False, 0.3, False)],
)
def test_what_the_model_may_miss_after_a_step_is_no_false_count_where_it_does(
    known_well: bool, share_missed: float, *, found: bool
) -> None:
    model, rng = identified(), np.random.default_rng(2)
    phase_deg = np.repeat(rng.uniform(30.0, 88.0, 100), 20)
    record = driven(phase_deg, 4)
    off = np.zeros(phase_deg.size)
    steps_rad_s = np.diff(CURVE.speed_rad_s(phase_deg[::20]), prepend=0.0)
    off[3::20] = share_missed * steps_rad_s * rng.normal(size=100)
    off[[203, 704, 1103, 1405]] = 25.0 * NOISE_RAD_S  # three windows after a step, or four
    (stretch,), _ = cut_runs([replace(record, speed_rad_s=record.speed_rad_s + off)], model, ())
    known = knowledge_of(model)
    noise = known.noise
    assert noise is not None
    if not known_well:
        lag = np.array([g in ("lag 3", "lag 4", "lag 5") for g in known.features.groups])
        known = replace(known, root=known.root + np.diag(0.5 * lag))
    problem = Problem([stretch], known, noise, [stretch.use])
    assert (find_sporadic(problem, (), 1.0) is not None) == found


def swinging(off_rad_s: float, *, behind: bool = False) -> tuple[Record, int]:
    """Return a run with windows off where the phase swings fastest, and how many.

    Either way, or all behind the move.
    """
    # From window to window the speed changes by some rad/s there.
    rows = np.arange(2000)
    turned = 2.0 * np.pi * rows / 47.3
    record = driven(80.0 * np.sin(turned), 6)
    hit, off = np.flatnonzero(np.abs(np.cos(turned)) > 0.9)[40::80], np.zeros(rows.size)
    way = -np.sign(np.gradient(record.speed_rad_s)[hit])
    off[hit] = off_rad_s * (way if behind else np.resize([1.0, -1.0], hit.size))
    return replace(record, speed_rad_s=record.speed_rad_s + off), hit.size


@pytest.mark.parametrize(
    ("off_rad_s", "behind", "found"), [(4.0, False, True), (1.0, False, True), (1.0, True, False)]
)
def test_what_no_late_command_makes_is_a_false_count_wherever_it_strikes(
    off_rad_s: float, *, behind: bool, found: bool
) -> None:
    record, n_hit = swinging(off_rad_s, behind=behind)
    sporadic = find_sporadic(problem_of([record]), (), 1.0)
    assert (sporadic is not None) == found
    if sporadic is not None:
        assert sporadic.named.name == "count_glitches"
        rate_hz = sporadic.applied.values["rate_hz"]
        assert rate_hz == pytest.approx(n_hit / (record.t_s.size * 0.01), rel=0.6)


def test_nobody_foresees_a_false_count_so_naming_it_gains_nothing() -> None:
    record, _ = swinging(4.0)
    found = diagnose([record], identified())
    assert [cause.name for cause in found.causes] == ["count_glitches"]
    assert found.verdict == "explained"
    assert found.gain == found.causes[0].gain == 0.0
    replayed = replay_record(record, found.extended)
    assert found.rmse_extended_rad_s == pytest.approx(replayed.rmse_rad_s, rel=0.1)
    assert any("no simulation foresees" in warning for warning in found.warnings)


@pytest.mark.parametrize(("counts", "found"), [(1, False), (2, True)])
def test_where_speeds_are_whole_counts_one_more_is_no_false_count(counts: int, found: bool) -> None:
    count_rad_s = 2.0 * np.pi / 2000.0 / WINDOW_S
    fine_deg = np.linspace(20.0, 88.0, 5000)
    phases_deg = np.interp(count_rad_s * np.arange(10, 32), CURVE.speed_rad_s(fine_deg), fine_deg)
    rng = np.random.default_rng(4)
    record = driven(np.repeat(rng.choice(phases_deg, 100), 20), 4)
    whole = np.rint(CURVE.speed_rad_s(record.phase_deg) / count_rad_s)
    whole[15::200] += counts
    problem = problem_of([replace(record, speed_rad_s=count_rad_s * whole)])
    assert whole_count_rad_s(problem.stretches[0]) == pytest.approx(count_rad_s)
    assert (find_sporadic(problem, (), 1.0) is not None) == found


def test_finer_speeds_are_no_whole_counts() -> None:
    (stretch,), _ = cut_runs([measured(4)], identified(), ())
    assert whole_count_rad_s(stretch) < 1e-5


@pytest.mark.parametrize(("off_rad_s", "told"), [(1.0, False), (1000.0, True)])
def test_one_window_beyond_any_motor_is_told(off_rad_s: float, told: bool) -> None:
    record = driven(np.repeat(np.random.default_rng(2).uniform(30.0, 88.0, 40), 20), 4)
    off = np.zeros(record.t_s.size)
    off[415] = off_rad_s
    found = diagnose([replace(record, speed_rad_s=record.speed_rad_s + off)], identified())
    assert found.causes == ()
    assert len([w for w in found.warnings if "stand alone" in w]) == told


@pytest.mark.parametrize(("struck", "found"), [(0.1, True), (1.0, False)], ids=["few", "all"])
def test_where_all_windows_of_a_phase_scatter_none_stands_alone(
    struck: float, *, found: bool
) -> None:
    """As they do where the curve is steep and the phase trembles."""
    rng = np.random.default_rng(12)
    phase_deg = 80.0 * np.sin(0.05 * np.arange(4000) * (1.0 + 1e-5 * np.arange(4000)))
    record = driven(phase_deg, 12)
    hit = (np.abs(phase_deg - 40.0) < 2.0) & (rng.random(phase_deg.size) < struck)
    off_rad_s = 10.0 * NOISE_RAD_S * rng.standard_normal(phase_deg.size)
    problem = problem_of([replace(record, speed_rad_s=record.speed_rad_s + hit * off_rad_s)])
    assert (find_sporadic(problem, (), 1.0) is not None) == found
