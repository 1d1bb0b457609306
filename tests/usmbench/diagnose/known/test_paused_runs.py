"""A motor that loses speed as it warms, in runs that were paused: what is known foretells it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.signal import lfilter

from known_motor import CURVE, LINEAR, NOISE_RAD_S, WINDOW_S
from usmbench.diagnose.known.warm_start_shapes import unsure_in_gaps
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.diagnose.residual.own_effects import cut_beside_own, known_of
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

N, AT, RESTS = 6000, 3000, 5
LOSES, CONSTANT_S = 0.02, 30.0
PAUSES_S = (300.0, 1000.0, 3500.0)


def day(seed: int, pause_s: float = 0.0, *, says: bool = True, goes_on: bool = False) -> Record:
    """Return a run from cold with a pause halfway, in which the motor stands unless it goes on."""
    rng = np.random.default_rng(seed)
    unseen = round(pause_s / WINDOW_S)
    on, seen = np.ones(N + unseen), np.ones(N + unseen, dtype=np.bool_)
    seen[AT : AT + unseen] = False
    if pause_s and not goes_on:
        on[AT : AT + unseen + RESTS] = 0.0
    kept = np.exp(-WINDOW_S / CONSTANT_S)
    warm = lfilter([1.0 - kept], [1.0, -kept], on)
    phase_deg = np.repeat(rng.uniform(-88.0, 88.0, on.size // 10 + 1), 10)[: on.size] * on
    settled = CURVE.speed_rad_s(phase_deg) * (1.0 - LOSES * warm) * on
    speed = free_run(LINEAR, settled) + NOISE_RAD_S * rng.standard_normal(on.size)
    t_s = WINDOW_S * np.arange(1.0, on.size + 1.0)
    whole = Record(f"run {seed}", t_s, phase_deg, speed, np.full(on.size, WINDOW_S))
    if says:
        whole = replace(whole, extra={"drive_on": on})
    elif pause_s:
        seen &= on > 0.0
    return whole.rows(seen)


@cache
def model(seed: int) -> HammersteinModel:
    runs = [day(100 * seed + k) for k in range(3)]
    return with_knowledge(identify_fast(runs, FastOptions(12)).model, runs)


@pytest.mark.parametrize("pause_s", PAUSES_S)
@pytest.mark.parametrize("seed", range(2))
def test_after_a_pause_it_is_foretold_as_fast_as_it_is_cold(seed: int, pause_s: float) -> None:
    known = known_of(model(seed))
    *_, after = cut_beside_own([day(100 * seed + 50, pause_s)], model(seed))[0]
    fast = after.use & (np.abs(after.simulated_rad_s) > 5.0)
    left_rad_s = after.residual_rad_s - known.expected_rad_s(after)
    share = np.mean(left_rad_s[fast] / after.simulated_rad_s[fast])
    cooled = LOSES * -np.expm1(-AT * WINDOW_S / CONSTANT_S)
    assert abs(share) < 0.1 * cooled


@pytest.mark.parametrize(("seed", "pause_s"), [(0, 300.0), (1, 3500.0)])
def test_a_pause_is_no_cause(seed: int, pause_s: float) -> None:
    found = diagnose([day(100 * seed + 60, pause_s)], model(seed))
    assert found.verdict == "no_discrepancy"
    assert not any("longer than" in words for words in found.warnings)


@pytest.mark.parametrize(("seed", "goes_on"), [(0, False), (1, True)])
def test_a_gap_is_no_cause_either_where_nobody_knows_what_the_motor_did(
    seed: int, goes_on: bool
) -> None:
    record = day(100 * seed + 70, 300.0, says=False, goes_on=goes_on)
    assert record.driven is None
    assert diagnose([record], model(seed)).verdict == "no_discrepancy"


@pytest.mark.parametrize("seed", range(2))
def test_it_may_be_off_by_what_either_would_do(seed: int) -> None:
    known = known_of(model(seed))
    stretches, _ = cut_beside_own([day(100 * seed + 80, 300.0, says=False)], model(seed))
    off_rad_s = list(unsure_in_gaps(stretches, known.features, known.mean))
    for s, off in zip(stretches, off_rad_s, strict=True):
        assert s.unsure_warmth is not None
        driven = known.expected_rad_s(replace(s, warmth=s.warmth + s.unsure_warmth))
        np.testing.assert_allclose(driven - known.expected_rad_s(s), off[:, 0], atol=1e-9)
    assert not off_rad_s[0].any()
    assert np.max(np.abs(off_rad_s[1])) > 0.01


def test_a_motor_that_has_stood_starts_as_on_another_day() -> None:
    known = known_of(model(0))
    stretches, _ = cut_beside_own([day(90, 300.0)], model(0))
    assert [(s.run, s.start) for s in stretches] == [(0, 0), (0, 1)]
    (_, once), (shapes, twice) = (
        known.background(given) for given in ([replace(s, start=0) for s in stretches], stretches)
    )
    n_own = known.wander.deviations.size
    assert twice.shape == (once.shape[0] + n_own, once.shape[1] + n_own)
    assert not shapes[0][:, -n_own:].any()
    assert not shapes[1][:, -2 * n_own : -n_own].any()
