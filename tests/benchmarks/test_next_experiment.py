"""The small version: delay or hysteresis in a triangle, the delay alone after the experiment."""

import importlib.util
import sys
from itertools import pairwise
from pathlib import Path

from hil_sim.defects import parse_defect
from usmbench.sweep.schedule import schedule

SCRIPT = Path(__file__).resolve().parents[2] / "benchmarks" / "next_experiment.py"


def test_the_proposed_experiment_decides_between_delay_and_hysteresis(tmp_path: Path) -> None:
    spec = importlib.util.spec_from_file_location("benchmark_next_experiment", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    benchmark = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = benchmark
    spec.loader.exec_module(benchmark)
    phases_deg = [dwell.phase_deg for dwell in schedule(benchmark.triangle(), 0.01)]
    steps_deg = {round(abs(b - a), 6) for a, b in pairwise(phases_deg)}
    assert len(steps_deg) == 1
    steps = list(benchmark.Motor(tmp_path, 1).decided(parse_defect("command_queue=80")))
    assert {"transport_delay", "dead_zone_hysteresis"} <= set(steps[0].named[0])
    assert len(steps) > 1
    assert all("Odds" in step.proposal for step in steps[:-1])
    assert steps[-1].named[0] == ("transport_delay",)
