"""How many counts are lost above some speed, and from which speed on."""

import numpy as np
import pytest

from known_motor import applied
from usmbench.model.effects.lone_windows import LoneWindows, SporadicEffect
from usmbench.model.effects.registry import find_effect


def test_a_share_that_grows_is_all_of_it_from_some_speed_on() -> None:
    growing = applied(
        "missed_counts", "more and more", share_lost=0.2, above_rad_s=4.0, within_rad_s=2.0
    )
    speed_rad_s = np.array([3.0, -4.0, 5.0, -6.0, 10.0])
    seen_rad_s = growing.effect.apply(speed_rad_s, None, growing.values)  # type: ignore[arg-type]
    assert seen_rad_s == pytest.approx([3.0, -4.0, 4.5, -4.8, 8.0])


@pytest.mark.parametrize("above_rad_s", [0.0, 2.0, 6.0])
def test_the_speed_from_which_single_windows_lose_counts_has_an_interval(
    above_rad_s: float,
) -> None:
    draw, held = np.random.default_rng(7), 0
    effect = find_effect("missed_counts", "now and then")
    assert isinstance(effect, SporadicEffect)
    for _ in range(20):
        # Levels of a staircase are alike up to rounding.
        speed_rad_s = np.repeat(np.arange(0.5, 10.0, 0.5), 300) + 1e-14 * draw.uniform(size=5700)
        alone = (speed_rad_s > above_rad_s) & (draw.uniform(size=5700) < 0.003)
        deviation_rad_s = np.where(alone, -1.0, 0.0)
        found = effect.weigh(LoneWindows.of_one_run(speed_rad_s, deviation_rad_s, alone, 0.01))
        low, value, high = found.values["above_rad_s"]
        assert low <= value <= high
        assert high - low >= 0.49
        held += low <= above_rad_s <= high
    assert held >= 17  # of 20 at 95 % fewer come in 1.6 %
