"""What a search sets aside as exceptions, and what it finds beside them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import sawtooth

from known_motor import NOISE_RAD_S, WINDOW_S, applied, driven
from tests.usmbench.diagnose.naming.searched_runs import DELAY, judged_rows, names_of, searched_run
from usmbench.model.hammerstein import HammersteinModel


def test_what_a_delay_leaves_in_one_window_a_stair_is_judged(model: HammersteinModel) -> None:
    stairs = np.linspace(-86.0, 86.0, 25)
    phase_deg = np.repeat(np.r_[stairs, stairs[::-1]], 60)
    offset = applied("phase_offset", "", offset_deg=0.6)
    found = searched_run(driven(phase_deg, 31, offset, DELAY), model)
    assert names_of(found) == {"phase_offset", "transport_delay"}
    assert judged_rows(found, np.flatnonzero(np.diff(phase_deg)) + 1).all()


@pytest.mark.parametrize("count_rad_s", [0.31, 0.8])
def test_counts_lost_where_the_motor_seldom_gets_are_no_exceptions(
    model: HammersteinModel, count_rad_s: float
) -> None:
    # A few windows in a thousand, each off by some counts: alone among all, not among their like.
    rng = np.random.default_rng(33)
    phase_deg = np.repeat(rng.uniform(-70.0, 70.0, 500), 4)
    fast = np.concatenate([np.arange(at, at + 6) for at in (300, 900, 1100, 1700)])
    phase_deg[fast] = np.where(fast < 1000, 88.0, -88.0)
    record = driven(phase_deg, 33)
    lost_rad_s = count_rad_s * rng.integers(1, 6, fast.size)
    record.speed_rad_s[fast] -= lost_rad_s * np.sign(phase_deg[fast])
    found = searched_run(record, model)
    assert names_of(found) == {"missed_counts"}
    assert judged_rows(found, fast).all()


def test_lost_counts_are_found_beside_another_cause_where_most_were_left_out(
    model: HammersteinModel,
) -> None:
    # Most windows with lost counts stand alone; six in a row do not, and nothing explains them.
    rng = np.random.default_rng(34)
    held_deg = rng.uniform(-75.0, 75.0, 250)
    held_deg[5::10] = 88.0 * (-1.0) ** np.arange(25)
    phase_deg = np.repeat(held_deg, 8)
    record = driven(phase_deg, 34, applied("phase_offset", "", offset_deg=0.15))
    top = np.abs(phase_deg) == 88.0
    lost = top & (rng.uniform(size=top.size) < 0.2)
    n_lost = np.where(lost, rng.integers(1, 6, top.size), 0)
    n_lost[np.flatnonzero(top)[17:23]] = 5
    count_rad_s = 2.0 * np.pi / 2000.0 / WINDOW_S
    counted = record.speed_rad_s - np.sign(record.speed_rad_s) * n_lost * count_rad_s
    found = searched_run(replace(record, speed_rad_s=counted), model)
    assert names_of(found) == {"missed_counts", "phase_offset"}
    assert judged_rows(found, np.flatnonzero(n_lost)).all()


def test_what_leaves_nothing_is_named_before_what_fits_worse_and_leaves_something(
    model: HammersteinModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A counter that loses the same of each window lacks the scatter of one that loses whole ones.

    Where data tell causes apart by halves only, whatever is half as good goes before it for that.
    """
    monkeypatch.setattr("usmbench.diagnose.naming.ranking.telling_deviance", lambda e: 0.5 * e)
    lost = applied("missed_counts", "of the excess", lost_of_excess=0.6, above_rad_s=3.5)
    record = driven(32.0 * sawtooth(0.02 * np.arange(4000.0), 0.5), 41, lost)
    found = searched_run(replace(record, meta={"encoder": {"counts_per_rev": 2000}}), model)
    assert found.names == ("missed_counts",)


def test_false_counts_beside_a_delay_are_exceptions(model: HammersteinModel) -> None:
    rng = np.random.default_rng(32)
    record = driven(np.repeat(rng.uniform(-88.0, 88.0, 500), 4), 32, DELAY)
    false = rng.choice(record.t_s.size, 20, replace=False)
    record.speed_rad_s[false] += 50.0 * NOISE_RAD_S
    found = searched_run(record, model)
    assert names_of(found) == {"transport_delay"}
    assert not judged_rows(found, false).any()


def test_a_contact_that_has_worn_is_found_beside_lost_counts(model: HammersteinModel) -> None:
    levels_deg = np.array([-85.0, -65, -40, -20, 0, 20, 45, 70, 85])
    phase_deg = np.repeat(np.random.default_rng(8).choice(levels_deg, 400), 5)
    worn = applied("speed_scale", "of the contact", scale_error=0.012)
    record = driven(phase_deg, 41, worn)
    count_rad_s = 2.0 * np.pi / 2000.0 / WINDOW_S
    speed_rad_s = np.abs(record.speed_rad_s)
    too_fast_rad_s = np.maximum(speed_rad_s - 10.2, 0.0)
    n_lost = np.random.default_rng(1).poisson(10.0 * too_fast_rad_s / count_rad_s)
    counted = np.sign(record.speed_rad_s) * (speed_rad_s - n_lost * count_rad_s)
    found = searched_run(replace(record, speed_rad_s=counted), model)
    assert names_of(found) == {"missed_counts", "speed_scale"}
    assert found.fit.effects[1].values["scale_error"] == pytest.approx(0.012, abs=0.004)
