"""A small run of the diagnosis' time benchmark, by the time that the simulation itself takes.

A machine is not as fast on one day as on another, nor beside another test.
"""

import time

import pytest

from benchmarks import diagnosis_time
from usmbench.model.effects.context import Context
from usmbench.model.extended import extended_run

MOST_FREE_RUNS = 12_000  # that a diagnosis takes as long as; by judgement


def _free_run_s(*, limited: bool) -> float:
    """Return the CPU time of one free run."""
    motor = diagnosis_time.motor(limited=limited)
    record, curve = diagnosis_time.run(2000, motor), motor.points[0].curve
    context = Context(record.t_s, 0.01, record.phase_deg, curve.speed_rad_s, motor.linear)
    began_s = time.process_time()
    for _ in range(200):
        extended_run([], context)
    return (time.process_time() - began_s) / 200


def test_a_short_run_is_diagnosed_in_time(capsys: pytest.CaptureFixture[str]) -> None:
    assert diagnosis_time.main(["--small", "--identified", "--limited"]) == 0
    n_windows, cpu_s, *_, verdict, cause = capsys.readouterr().out.splitlines()[-1].split()
    assert (n_windows, verdict, cause) == ("2000", "explained", "gain_asymmetry")
    assert float(cpu_s) < MOST_FREE_RUNS * _free_run_s(limited=True)


def test_what_has_no_name_takes_the_longest_and_gets_none(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert diagnosis_time.main(["--small", "--unnamed"]) == 0
    n_windows, cpu_s, *_, verdict = capsys.readouterr().out.splitlines()[-1].split()
    assert (n_windows, verdict) == ("2000", "unexplained")
    assert float(cpu_s) < MOST_FREE_RUNS * _free_run_s(limited=False)
