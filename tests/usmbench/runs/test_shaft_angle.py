"""An angle that does not go with the speed is not used."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.runs.record import Record
from usmbench.runs.shaft_angle import angle_goes_with_speed, angle_warnings


def run(angle_of: str) -> Record:
    """Return a run to and fro of 2000 windows, its angle made in one way or another."""
    t_s = 0.01 * np.arange(1.0, 2001.0)
    speed_rad_s = 9.0 * np.sin(0.7 * t_s) + 0.05 * np.random.default_rng(1).standard_normal(2000)
    angle_rad = np.cumsum(speed_rad_s) * 0.01
    made: dict[str, NDArray[np.float64] | None] = {
        "right": angle_rad,
        "wrapped": angle_rad % (2.0 * np.pi),
        "begun elsewhere": angle_rad + 40.0,
        "unsigned": np.cumsum(np.abs(speed_rad_s)) * 0.01,
        "missing": None,
        "zero": np.zeros(2000),
        "in degrees": np.degrees(angle_rad),
        "in turns": angle_rad / (2.0 * np.pi),
    }
    nothing = np.zeros(2000)
    record = Record("run", t_s, nothing, speed_rad_s, np.full(2000, 0.01))
    return replace(record, angle_rad=made[angle_of])


@pytest.mark.parametrize("angle_of", ["right", "wrapped", "begun elsewhere", "unsigned", "missing"])
def test_an_angle_that_turns_with_the_speed(angle_of: str) -> None:
    assert angle_goes_with_speed(run(angle_of))
    assert angle_warnings(run(angle_of)) == []


@pytest.mark.parametrize("angle_of", ["zero", "in degrees", "in turns"])
def test_an_angle_that_does_not(angle_of: str) -> None:
    assert not angle_goes_with_speed(run(angle_of))
    (warning,) = angle_warnings(run(angle_of))
    assert warning.startswith("run: angle_rad does not turn as speed_rad_s says")


def test_a_few_false_windows_say_nothing_against_it() -> None:
    record = run("right")
    speed_rad_s = record.speed_rad_s.copy()
    speed_rad_s[::10] = 500.0
    assert angle_goes_with_speed(replace(record, speed_rad_s=speed_rad_s))


def test_a_shaft_that_stands_says_nothing() -> None:
    record = run("zero")
    assert angle_goes_with_speed(replace(record, speed_rad_s=np.zeros(2000)))
