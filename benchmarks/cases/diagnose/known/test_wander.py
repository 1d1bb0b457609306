"""What differs from run to run: what moves with it, how far, and that it is no news."""

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.usmbench.diagnose.known.wandering_motor import (
    LINEAR,
    NOISE_RAD_S,
    WINDOW_S,
    driven,
    slipping_motor,
)
from usmbench.diagnose.known.wander import wander_from_mapping
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

Array = NDArray[np.float64]
N = 1200


@pytest.fixture(scope="module")
def plain() -> HammersteinModel:
    return slipping_motor()


def test_friction_wanders_at_each_operating_point_by_its_own_amount(
    plain: HammersteinModel,
) -> None:
    off = 0.03 * np.array([-1.2, 0.4, 1.1, -0.3, 0.9, -0.9])
    model = with_knowledge(
        plain, [driven(k, 1.0, 1.0 + c, n=N) for k, c in enumerate(off, start=10)]
    )
    wander = wander_from_mapping(model.residual["diagnosis"])
    low_rad_s, high_rad_s = wander.held_back_rad_s
    assert low_rad_s < 0.3 * high_rad_s
    assert 0.5 < high_rad_s / np.std(off, ddof=1) < 2.0
    assert wander.gain < 1e-3


def test_a_gain_that_wanders_more_at_one_frequency_is_no_drift(plain: HammersteinModel) -> None:
    """Half of a run at each frequency: what differs between them looks like time passing."""
    off = 0.01 * np.array([-1.2, 0.4, 1.1, -0.3, 0.9, -0.9])
    days = [driven(k, 1.0 + g, 1.0, tilt=0.2 * g, n=N) for k, g in enumerate(off, start=10)]
    model = with_knowledge(plain, days)
    wander = wander_from_mapping(model.residual["diagnosis"])
    assert wander.gain_tilt[1] == pytest.approx(0.2 * np.std(off, ddof=1), rel=0.5)
    for seed, gain in ((1, 0.012), (2, -0.01)):
        record = driven(seed, 1.0 + gain, 1.0, tilt=0.2 * gain, n=N)
        assert diagnose([record], model).verdict == "no_discrepancy"


def test_commands_that_meet_the_windows_sooner_or_later_are_no_news(
    plain: HammersteinModel,
) -> None:
    late_s = 1e-4 * np.array([-1.2, 0.4, 1.1, -0.3, 0.9, -0.9])
    model = with_knowledge(
        plain, [driven(k, 1.0, 1.0, late_s=t, n=N) for k, t in enumerate(late_s, start=10)]
    )
    wander = wander_from_mapping(model.residual["diagnosis"])
    assert 0.7 < wander.late_s / np.std(late_s, ddof=1) < 2.0
    assert wander.gain < 1e-3
    for seed, t in ((1, 1.2e-4), (2, -1e-4)):
        assert diagnose([driven(seed, 1.0, 1.0, late_s=t, n=N)], model).verdict == "no_discrepancy"


def test_the_runs_show_how_much_their_warm_up_differs(plain: HammersteinModel) -> None:
    off = np.array([-1.2, 0.4, 1.1, -0.3, 0.9, -0.9])
    shares = []
    for spread in (0.0, 0.3):
        days = enumerate(0.02 * (1.0 + spread * off), start=10)
        model = with_knowledge(plain, [driven(k, 1.0, 1.0, warms=w) for k, w in days])
        shares.append(wander_from_mapping(model.residual["diagnosis"]).warms_gain)
    alike, otherwise = shares
    assert alike < 5e-4
    # Their time constant is the shortest of those that count.
    assert 0.2 < otherwise / (0.006 * np.std(off, ddof=1)) < 1.0


@pytest.mark.parametrize("rises", [0.5, 1.5])
def test_a_dead_zone_that_wanders_is_no_news_however_the_rotor_starts(rises: float) -> None:
    off = 0.01 * np.array([-1.2, 0.4, 1.1, -0.3, 0.9, -0.9])
    days = [_starting(k, rises, 1.0 + w) for k, w in enumerate(off, start=10)]
    model = with_knowledge(identify_fast(days, FastOptions()).model, days)
    wander = wander_from_mapping(model.residual["diagnosis"])
    assert 0.5 < wander.wider / np.std(off, ddof=1) < 2.0
    for seed, wider in ((1, 1.012), (2, 0.99)):
        assert diagnose([_starting(seed, rises, wider)], model).verdict == "no_discrepancy"


def test_to_warm_for_longer_than_was_watched_is_no_drift() -> None:
    days = [_starting(k, 1.0, 1.0, warms=0.008) for k in range(10, 14)]
    model = with_knowledge(identify_fast(days, FastOptions()).model, days)
    found = diagnose([_starting(2, 1.0, 1.0, warms=0.008, lasts_s=150.0)], model)
    assert "thermal_drift" not in {cause.name for cause in found.causes}
    assert any("how the motor warms" in words for words in found.warnings)


@pytest.mark.parametrize("wanders", [True, False])
def test_an_offset_that_wanders_from_day_to_day_is_no_news(wanders: bool) -> None:
    offset_deg = wanders * 0.06 * np.array([-1.2, 0.4, 1.1, -0.3, 0.9, -0.9])
    days = [_starting(k, 1.0, 1.0, offset_deg=o) for k, o in enumerate(offset_deg, start=10)]
    model = with_knowledge(identify_fast(days, FastOptions()).model, days)
    found = diagnose([_starting(1, 1.0, 1.0, offset_deg=0.07)], model)
    assert [cause.name for cause in found.causes] == ([] if wanders else ["phase_offset"])


def test_a_dead_zone_that_wanders_is_no_friction_where_the_rotor_is_let_go() -> None:
    """In the window of a jump to 0° it still turns, as fast as on the side that it left."""
    off = 0.01 * np.array([-1.2, 0.4, 1.1, -0.3, 0.9, -0.9])
    levels_deg = tuple(np.linspace(-88.0, 88.0, 9))
    days = [
        _starting(k, 1.0, 1.0 + w, levels_deg=levels_deg if k % 2 else ())
        for k, w in enumerate(off, start=10)
    ]
    model = with_knowledge(identify_fast(days, FastOptions()).model, days)
    wander = wander_from_mapping(model.residual["diagnosis"])
    assert 0.7 < wander.wider / np.std(off, ddof=1) < 1.5
    assert max(wander.held_back_rad_s) < 0.01
    for seed, wider in ((1, 1.02), (2, 0.98)):
        record = _starting(seed, 1.0, wider, levels_deg=levels_deg)
        assert diagnose([record], model).verdict == "no_discrepancy"


@pytest.mark.parametrize("seed", range(2))
def test_edges_that_wander_apart_while_the_curve_ends_where_it_did_are_no_news(seed: int) -> None:
    rng = np.random.default_rng([seed, 3])
    days = [_stretched(10 * seed + k, rng.normal(0.0, 0.01, 2)) for k in range(4)]
    model = with_knowledge(identify_fast(days, FastOptions()).model, days)
    healthy = [_stretched(50 + 10 * seed + k, rng.normal(0.0, 0.01, 2)) for k in range(3)]
    assert diagnose(healthy, model).verdict == "no_discrepancy"


def _stretched(seed: int, farther: Array) -> Record:
    """Return a run of a motor that starts farther out by a share, either side, and ends at 90."""
    rng = np.random.default_rng(seed)
    phase_deg = np.repeat(rng.uniform(-88.0, 88.0, 300), 10)
    t_s, edge_deg = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0), 13.0
    moved_deg = edge_deg * (1.0 + np.where(phase_deg > 0.0, farther[0], farther[1]))
    share = np.maximum(np.abs(phase_deg) - moved_deg, 0.0) / (90.0 - moved_deg)
    settled = 10.0 * np.sign(phase_deg) * np.sin(1.2 * share)
    speed = free_run(LINEAR, settled) + 0.01 * rng.standard_normal(phase_deg.size)
    return Record(f"run {seed}", t_s, phase_deg, speed, np.full(phase_deg.size, WINDOW_S))


def _starting(
    seed: int,
    rises: float,
    wider: float,
    *,
    warms: float = 0.0,
    lasts_s: float = 20.0,
    offset_deg: float = 0.0,
    levels_deg: tuple[float, ...] = (),
) -> Record:
    """Return a run of a motor that starts at 9 degrees one way and at 13 the other."""
    rng = np.random.default_rng(seed)
    n_stays = round(10.0 * lasts_s)
    stays_deg = rng.choice(levels_deg, n_stays) if levels_deg else rng.uniform(-88.0, 88.0, n_stays)
    phase_deg = np.repeat(stays_deg, 10)
    t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
    moved_deg = phase_deg + offset_deg
    way = np.sign(moved_deg)
    beyond_deg = np.maximum(np.abs(moved_deg) - wider * np.where(way > 0.0, 9.0, 13.0), 0.0)
    settled = 10.0 * way * np.tanh((beyond_deg / 25.0) ** rises)
    settled *= 1.0 + warms * np.expm1(-t_s / 300.0)
    speed = free_run(LINEAR, settled) + NOISE_RAD_S * rng.standard_normal(phase_deg.size)
    return Record(f"run {seed}", t_s, phase_deg, speed, np.full(phase_deg.size, WINDOW_S))


def test_a_gain_that_wanders_but_for_the_slip_is_no_news(plain: HammersteinModel) -> None:
    off = 0.015 * np.array([-1.2, 0.4, 1.1, -0.3, 0.9, -0.9])
    model = with_knowledge(
        plain, [driven(k, 1.0 + g, 1.0, n=N) for k, g in enumerate(off, start=10)]
    )
    assert diagnose([driven(1, 1.014, 1.0, n=N)], model).verdict == "no_discrepancy"
