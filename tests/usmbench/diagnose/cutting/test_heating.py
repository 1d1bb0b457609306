"""How warm a run has made the motor where its log has a gap: off, driven, or nobody knows."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from usmbench.diagnose.cutting.heating import heating
from usmbench.diagnose.cutting.tabled_curve import NODES_DEG
from usmbench.diagnose.cutting.warmth import TIME_CONSTANTS_S
from usmbench.runs.record import Record

N, AT, WINDOW_S = 600, 300, 0.01
Array = NDArray[np.float64]


def paused(seed: int, gap_s: float) -> Record:
    rng = np.random.default_rng(seed)
    t_s = WINDOW_S * np.arange(1.0, N + 1.0)
    t_s[AT:] += gap_s
    phase_deg = rng.uniform(-90.0, 90.0, N)
    return Record("run", t_s, phase_deg, 0.1 * phase_deg, np.full(N, WINDOW_S))


def heated(record: Record) -> tuple[Array, Array | None]:
    (found,) = heating(record, [np.ones(N)], [0.1 * NODES_DEG], [np.arange(N)])
    return found


def off_after_the_gap(record: Record) -> Record:
    drive_on = np.ones(N)
    drive_on[AT] = 0.0
    return replace(record, extra={"drive_on": drive_on})


@settings(deadline=None, max_examples=20)
@given(seed=st.integers(0, 1000), gap_s=st.floats(2.0, 3500.0))
def test_a_run_that_was_taken_up_cools_in_its_pause(seed: int, gap_s: float) -> None:
    warm, unsure = heated(off_after_the_gap(paused(seed, gap_s)))
    assert unsure is None
    fades = np.exp(-(gap_s + WINDOW_S) / np.array(TIME_CONSTANTS_S))
    np.testing.assert_allclose(warm[:, :, AT], warm[:, :, AT - 1] * fades, rtol=1e-9)


@settings(deadline=None, max_examples=20)
@given(seed=st.integers(0, 1000), gap_s=st.floats(2.0, 3500.0))
def test_where_nobody_knows_it_is_halfway_and_either_end_is_one_deviation_off(
    seed: int, gap_s: float
) -> None:
    record = paused(seed, gap_s)
    warm, unsure = heated(record)
    assert unsure is not None
    assert not unsure[:, :, :AT].any()
    # By being driven at all: at the gap's end, had it been off, and had it not.
    kept = np.exp(-WINDOW_S / np.array(TIME_CONSTANTS_S))
    fades = np.exp(-gap_s / np.array(TIME_CONSTANTS_S))
    before = warm[0, :, AT - 1] * fades
    for sign, met in ((-1.0, 0.0), (1.0, 1.0)):
        end = before + met * (1.0 - fades)
        expected = kept * end + (1.0 - kept)
        np.testing.assert_allclose((warm + sign * unsure)[0, :, AT], expected, rtol=1e-9)


def test_rows_without_drive_do_not_warm() -> None:
    record = replace(paused(0, 0.0), extra={"drive_on": np.zeros(N)})
    warm, unsure = heated(record)
    assert unsure is None
    assert not warm.any()


def test_a_lost_row_is_no_pause() -> None:
    record = paused(0, 0.0)
    whole, _ = heated(record)
    kept = np.arange(N) != AT
    ((warm, unsure),) = heating(
        record.rows(kept), [np.ones(N - 1)], [0.1 * NODES_DEG], [np.arange(N - 1)]
    )
    assert unsure is None
    np.testing.assert_allclose(warm[0], whole[0][:, kept], atol=1e-12)
    assert whole[0, 0, -1] == pytest.approx(-np.expm1(-N * WINDOW_S / TIME_CONSTANTS_S[0]))


def test_a_speed_that_no_motor_makes_warms_nothing() -> None:
    record = paused(3, 0.0)
    wild = replace(record, speed_rad_s=record.speed_rad_s.copy())
    wild.speed_rad_s[200] = 1e6
    (warm, _), (warmed, _) = heated(record), heated(wild)
    np.testing.assert_allclose(warmed, warm, rtol=0.02)
