"""Delay, hysteresis or backlash in a triangle: one of them alone after the experiment."""

from itertools import pairwise

from benchmarks import next_experiment
from usmbench.sweep.schedule import schedule


def test_the_triangle_has_one_rate() -> None:
    phases_deg = [dwell.phase_deg for dwell in schedule(next_experiment.triangle(), 0.01)]
    assert len({round(abs(b - a), 6) for a, b in pairwise(phases_deg)}) == 1
