"""The small version of the benchmark runs and prints every line of its tables."""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_small_run_prints_each_figure() -> None:
    printed = subprocess.run(
        [sys.executable, "benchmarks/motor_characteristics.py", "--small"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    ).stdout
    full_rad_s = re.search(r"full speed at 90°, rad/s +([0-9.]+)", printed)
    assert full_rad_s is not None
    assert 10.0 < float(full_rad_s[1]) < 10.5
    for figure in ("lag of a step", "dead zone", "Warm-up", "steady drive", "off, at rest"):
        assert figure in printed
