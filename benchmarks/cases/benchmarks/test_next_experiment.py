"""Delay, hysteresis or backlash in a triangle: one of them alone after the experiment."""

from pathlib import Path

from benchmarks import next_experiment
from hil_sim.defects import parse_defect


def test_friction_that_sticks_is_named_alone_in_the_end(tmp_path: Path) -> None:
    steps = list(next_experiment.Motor(tmp_path, 3).decided(parse_defect("sticky_friction=60")))
    assert steps[-1].named[0] == ("dead_zone_hysteresis",)


def test_the_proposed_experiment_decides_between_delay_and_hysteresis(tmp_path: Path) -> None:
    steps = list(next_experiment.Motor(tmp_path, 1).decided(parse_defect("command_queue=40")))
    assert {"transport_delay", "dead_zone_hysteresis"} <= set(steps[0].named[0])
    assert len(steps) > 1
    assert all("Odds" in step.proposal for step in steps[:-1])
    assert steps[-1].named[0] == ("transport_delay",)
