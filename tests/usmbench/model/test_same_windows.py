"""A model's dynamics hold for the windows it was identified on."""

from dataclasses import replace

import pytest

from usmbench.errors import InputError
from usmbench.model.effects.first_order import first_order
from usmbench.model.same_windows import check_windows

LAG = first_order(0.0035, 0.0, 0.01)


@pytest.mark.parametrize("window_s", [0.01, 0.01002, 0.00998])
def test_a_clock_that_jitters_is_taken(window_s: float) -> None:
    check_windows("run", window_s, LAG)


def test_other_windows_are_refused_with_both_numbers() -> None:
    with pytest.raises(InputError, match=r"^run has windows of 20 ms.*identified on 10 ms; "):
        check_windows("run", 0.02, LAG)


def test_milliseconds_are_asked_about() -> None:
    with pytest.raises(InputError, match="milliseconds, divide it by 1000"):
        check_windows("run", 10.0, LAG)


def test_a_model_of_settled_pairs_takes_any() -> None:
    check_windows("run", 0.02, replace(LAG, window_s=None))
