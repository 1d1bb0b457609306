"""An error beyond the noise that is no finding is explained, and never called noise."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from usmbench.diagnose.result import Diagnosis
from usmbench.report.error_text import noise_note, what_is_left

Make = Callable[..., Diagnosis]


def test_an_error_beyond_the_noise_is_said_to_be_known(make_diagnosis: Make) -> None:
    diagnosis = make_diagnosis(remainder=None)
    said = what_is_left(diagnosis)
    assert said.startswith("0.09 rad/s are left, where the bench's noise far from steps is 0.04")
    assert "the simulation misses as much on its own runs" in said
    assert said.endswith("and no figure above leaves its grey band.")
    assert noise_note(diagnosis) == "what a simulation without any error would leave far from steps"


def test_a_figure_beyond_its_band_is_not_hidden(make_diagnosis: Make) -> None:
    views = (replace(make_diagnosis().views[0], excess_after=1.23),)
    said = what_is_left(make_diagnosis(remainder=None, views=views))
    assert "(1.2\N{NO-BREAK SPACE}× at the most)" in said
    assert "no figure" not in said


@pytest.mark.parametrize("rmse_rad_s", [0.04, 0.040001])
def test_an_error_of_the_noise_is_noise(make_diagnosis: Make, rmse_rad_s: float) -> None:
    diagnosis = make_diagnosis(remainder=None, rmse_extended_rad_s=rmse_rad_s)
    assert what_is_left(diagnosis) == "The 0.04 rad/s that are left are the bench's noise."


def test_nothing_larger_than_the_noise_is_left_where_they_are_equal(make_diagnosis: Make) -> None:
    assert noise_note(make_diagnosis(rmse_extended_rad_s=0.04)) == "all that is left"


def test_a_remainder_says_what_it_is(make_diagnosis: Make) -> None:
    said = what_is_left(make_diagnosis())
    assert said == "Something is left: the residual changes over the run."


def test_an_error_beyond_that_of_the_own_runs_is_not_called_usual(make_diagnosis: Make) -> None:
    said = what_is_left(make_diagnosis(remainder=None, left_over=6.6))
    assert "That is 6.6\N{NO-BREAK SPACE}× what the simulation misses on its own runs." in said
    assert "no news" not in said
    assert "misses as much" not in said


@pytest.mark.parametrize("by_chance", [True, False])
def test_what_a_cause_does_by_chance_is_no_difference_between_days(
    make_diagnosis: Make, *, by_chance: bool
) -> None:
    (cause,) = make_diagnosis().causes
    glitches = replace(cause, name="count_glitches", alternatives=(), by_chance=by_chance)
    said = what_is_left(make_diagnosis(remainder=None, left_over=6.6, causes=(glitches,)))
    assert ("foresees which windows count glitches strikes" in said) == by_chance
    assert ("between days" in said) != by_chance
