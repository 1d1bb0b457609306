"""A run as a motor with effects in it is driven."""

import numpy as np
import pytest

from known_motor import applied
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.residual.shown_motor import shown_by


@pytest.mark.parametrize("offset_deg", [0.0, 1.5])
def test_steps_are_those_of_the_phases_that_are_set(
    stretches: list[Stretch], offset_deg: float
) -> None:
    (stretch,) = stretches
    effects = [applied("phase_offset", "", offset_deg=offset_deg)]
    shown = shown_by(stretch, np.zeros(stretch.context.n), effects)
    phase_deg, curve = stretch.context.phase_deg, stretch.context.settled_rad_s
    assert shown.context.phase_deg == pytest.approx(phase_deg + offset_deg)
    settled_rad_s = curve(phase_deg + offset_deg)
    assert shown.settled_rad_s == pytest.approx(settled_rad_s)
    for row in range(5, 200, 5):
        step_rad_s = settled_rad_s[row] - settled_rad_s[row - 1]
        assert shown.step_rad_s[row : row + 5] == pytest.approx(step_rad_s)
    if not offset_deg:
        assert shown.step_rad_s == pytest.approx(stretch.step_rad_s)


def test_swapped_outputs_step_the_other_way(stretches: list[Stretch]) -> None:
    (stretch,) = stretches
    swapped = [applied("swapped_channels", "of the drive")]
    shown = shown_by(stretch, np.zeros(stretch.context.n), swapped)
    top_rad_s = float(np.max(np.abs(stretch.settled_rad_s)))
    # The two directions of this motor differ by a few per cent.
    assert shown.settled_rad_s == pytest.approx(-stretch.settled_rad_s, abs=0.05 * top_rad_s)
    assert shown.step_rad_s == pytest.approx(-stretch.step_rad_s, abs=0.05 * top_rad_s)
    assert np.array_equal(shown.direction, -stretch.direction)
    by_counter = shown_by(stretch, np.zeros(stretch.context.n), [applied("swapped_channels", "")])
    assert by_counter.step_rad_s is stretch.step_rad_s


def test_what_is_known_of_the_curve_comes_as_late_as_the_commands(
    stretches: list[Stretch],
) -> None:
    (stretch,) = stretches
    late = [applied("transport_delay", "", delay_s=0.04)]
    shown = shown_by(stretch, np.zeros(stretch.context.n), late)
    before, after = (s.context.linear.dead_time_windows for s in (stretch, shown))
    assert after == before + 4
