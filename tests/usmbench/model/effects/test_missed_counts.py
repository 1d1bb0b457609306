"""How many counts are lost above some speed, and from which speed on."""

import numpy as np
import pytest

from known_motor import applied


def test_a_share_that_grows_is_all_of_it_from_some_speed_on() -> None:
    growing = applied(
        "missed_counts", "more and more", share_lost=0.2, above_rad_s=4.0, within_rad_s=2.0
    )
    speed_rad_s = np.array([3.0, -4.0, 5.0, -6.0, 10.0])
    seen_rad_s = growing.effect.apply(speed_rad_s, None, growing.values)  # type: ignore[arg-type]
    assert seen_rad_s == pytest.approx([3.0, -4.0, 4.5, -4.8, 8.0])
