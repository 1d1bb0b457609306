"""What is off in a part of the runs only, and what merely seems to be."""

import numpy as np
import pytest

from known_motor import applied, driven, measured, problem_of
from usmbench.diagnose.naming.confined import confined
from usmbench.model.applied import Applied
from usmbench.runs.record import Record

OFFSET = applied("phase_offset", "", offset_deg=1.5)


def _partly(begins: float, ends: float) -> tuple[Record, float, float]:
    """Return a run that shows the offset between two shares of its time, and these times."""
    record, plain = measured(51, OFFSET), measured(51)
    first_s, last_s = begins * record.t_s[-1], ends * record.t_s[-1]
    there = (record.t_s > first_s) & (record.t_s <= last_s)
    record.speed_rad_s[~there] = plain.speed_rad_s[~there]
    return record, first_s, last_s


@pytest.mark.parametrize(("begins", "ends"), [(0.0, 0.4), (0.3, 0.7), (0.55, 1.0)])
def test_what_came_or_went_is_told_with_its_time(begins: float, ends: float) -> None:
    record, first_s, last_s = _partly(begins, ends)
    found = confined(problem_of([record]), ())
    assert found is not None
    assert found.versus == "time"
    told = found.says.split(" is in ")[1].split(" s,")[0].split(" to ")
    assert [float(t) for t in told] == pytest.approx([first_s, last_s], abs=1.0)


def test_what_one_run_shows_alone_is_told_with_its_name() -> None:
    found = confined(problem_of([measured(52), measured(53, OFFSET), measured(54)]), ())
    assert found is not None
    assert found.versus == "run"
    assert "run 53," in found.says
    assert not any(f"run {other}" in found.says for other in (52, 54))


@pytest.mark.parametrize(
    "cause",
    [
        OFFSET,
        applied("gain_asymmetry", "balanced", asymmetry=0.03),
        applied("slow_dynamics", "", added_s=0.02),
        applied("encoder_eccentricity", "", cosine=0.02, sine=0.0),
    ],
)
@pytest.mark.parametrize("slow", [True, False])
def test_what_comes_and_goes_with_the_plan_is_not_confined(cause: Applied, *, slow: bool) -> None:
    """Once up and down, each phase and way comes at one time only."""
    once_deg = np.r_[np.linspace(-88.0, 88.0, 700), np.linspace(88.0, -88.0, 700)]
    problem = problem_of([driven(once_deg, 55, cause) if slow else measured(55, cause)])
    assert np.mean(problem.left(()) ** 2) > 1.5
    assert confined(problem, ()) is None
