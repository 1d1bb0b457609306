"""Steps of which a model only guesses how large they are."""

from dataclasses import replace

import numpy as np

from benchmarks.identification_few_phases import PHASES_DEG, telegraphs
from benchmarks.plain_motor import Wrong, motor_of, speed_rad_s
from known_motor import WINDOW_S
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.runs.record import Record

STAIRS_DEG = np.tile(np.repeat(np.r_[np.arange(-78.0, 79, 6), np.arange(78.0, -79, -6)], 8), 3)
NOISE_RAD_S = 0.008


def test_a_motor_that_brakes_faster_is_healthy_between_the_few_phases_it_is_known_at() -> None:
    rng, n = np.random.default_rng(2), STAIRS_DEG.size
    motor = replace(motor_of(rng), brakes_in=0.35)
    runs = telegraphs(motor, PHASES_DEG[0], rng, ("one", "two", "three"), NOISE_RAD_S)
    model = with_knowledge(identify_fast(runs, FastOptions()).model, runs)
    speed, _ = speed_rad_s(motor, STAIRS_DEG, WINDOW_S, Wrong(), rng)
    noisy, t_s = speed + NOISE_RAD_S * rng.standard_normal(n), WINDOW_S * np.arange(1.0, n + 1.0)
    day = Record("day", t_s, STAIRS_DEG, noisy, np.full(n, WINDOW_S))
    assert diagnose([day], model).verdict == "no_discrepancy"
