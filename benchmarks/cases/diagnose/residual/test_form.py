"""What a large effect leaves of itself is no news, and what acts where it does not is."""

from dataclasses import replace

import pytest

from known_motor import applied, identified, measured
from usmbench.diagnose.pipeline import diagnose


@pytest.mark.parametrize(("added_s", "named"), [(5.2e-3, []), (9e-3, ["slow_dynamics"])])
def test_an_extended_model_may_be_off_in_form_and_sees_what_has_grown(
    added_s: float, named: list[str]
) -> None:
    lag = applied("slow_dynamics", "", added_s=5e-3)
    extended = replace(identified(), effects=(lag.to_mapping(),))
    record = measured(5, applied("slow_dynamics", "", added_s=added_s))
    assert [cause.name for cause in diagnose([record], extended).causes] == named
