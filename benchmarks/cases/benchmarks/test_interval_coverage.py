"""Intervals hold the truth, of shapes that trade with a size, too."""

from benchmarks.interval_coverage import Motor, held
from usmbench.model.applied import Applied
from usmbench.model.effects.registry import find_effect


def test_the_interval_of_a_time_constant_follows_what_it_trades_with() -> None:
    motor = Motor(1, 1500)
    warming = Applied(
        find_effect("thermal_drift", "speed"), {"final_drift": 0.02, "warm_up_s": 12.0}
    )
    found = [held(motor, warming) for _ in range(7)]
    named = [one for one in found if one is not None]
    assert len(named) >= 5
    # Of seven intervals of 95 %, chance lets fewer than 70 % hold once in 266 times.
    assert sum(one["warm_up_s"] for one in named) >= 0.7 * len(named)
