"""The small version of the loop's cost: a second or two of CPU time."""

import importlib.util
import sys
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "benchmarks" / "sweep_loop.py"


def test_the_loop_takes_no_more_than_it_may() -> None:
    spec = importlib.util.spec_from_file_location("benchmark_sweep_loop", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    sweep_loop = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = sweep_loop
    spec.loader.exec_module(sweep_loop)
    # The least of many short ones: the other core runs tests, too.
    loop_s, decode_s = sweep_loop.measure(1_000, repeats=20)
    assert decode_s > 0
    assert loop_s < sweep_loop.ALLOWED_S
