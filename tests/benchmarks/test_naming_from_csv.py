"""Plain runs in CSV files through the commands, a few of them."""

import numpy as np
import pytest

from benchmarks.naming_from_csv import draw
from benchmarks.plain_motor import Wrong, motor_of, size_for, sizes_of, speed_rad_s
from benchmarks.plain_outcome import NOTHING, OUTSIDE, Conditions, Outcome, report
from benchmarks.plain_runs import noise_rad_s, plan_deg

HOW = Conditions("random", 600, 90.0, 0.01, 0.03, 0.0, 1)


def test_a_short_healthy_run_is_no_finding() -> None:
    outcome = draw(11, 0, NOTHING, 1.5)
    assert outcome.right
    assert not outcome.names


def test_a_plain_cause_is_named() -> None:
    assert draw(11, 0, "missed_counts", 3.0).right


def test_what_is_right(capsys: pytest.CaptureFixture[str]) -> None:
    named, silent = (("speed_scale", "load_torque"),), ()
    first = Outcome("speed_scale", 1.5, HOW, named, "explained")
    other = Outcome("load_torque", 1.5, HOW, named, "explained")
    kept = Outcome(OUTSIDE, 1.5, HOW, silent, "unexplained")
    alarm = Outcome(NOTHING, 1.5, HOW, silent, "unexplained")
    failed = Outcome(OUTSIDE, 1.5, HOW, silent, "usmbench: measured.csv: too short")
    assert (first.right, other.right, kept.right, alarm.right) == (True, False, True, False)
    assert (first.in_set, other.in_set, alarm.in_set) == (True, True, True)
    assert (failed.right, failed.in_set) == (False, False)
    report([first, other, kept, alarm])
    assert "all of the library                50.0" in capsys.readouterr().out


@pytest.mark.parametrize("colour", [0.0, 0.6])
def test_noise_has_its_size_and_colour(colour: float) -> None:
    noise = noise_rad_s(20_000, 0.05, colour, np.random.default_rng(0))
    assert np.std(noise) == pytest.approx(0.05, rel=0.05)
    assert np.corrcoef(noise[1:], noise[:-1])[0, 1] == pytest.approx(colour, abs=0.03)


def test_a_size_is_found_and_does_as_much() -> None:
    rng = np.random.default_rng(5)
    motor, phase_deg = motor_of(rng), plan_deg("random", 600, 90.0, rng)

    def rms(size: float) -> float:
        moved, still = (
            speed_rad_s(motor, phase_deg, 0.01, wrong, np.random.default_rng(0))[0]
            for wrong in (Wrong("phase_offset", size), Wrong())
        )
        return float(np.sqrt(np.mean((moved - still) ** 2)))

    size = size_for(rms, sizes_of("phase_offset"), 0.05)
    assert size is not None
    assert 0.05 <= rms(size) < 0.065
    assert size_for(lambda _: 0.0, np.ones(3), 0.05) is None
