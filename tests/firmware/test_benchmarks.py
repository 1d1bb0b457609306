"""The firmware's benchmarks, small: fuzz against the emulated board, figures, a whole sweep."""

import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.mark.parametrize(
    ("benchmark", "says"),
    [
        ("firmware_fuzz.py", "are equal"),
        ("firmware_figures.py", "errors on bus and line: none"),
        ("firmware_sweep.py", "phases, frequencies, windows equal"),
    ],
)
def test_small_benchmarks_keep_their_limits(benchmark: str, says: str) -> None:
    done = subprocess.run(
        [sys.executable, BENCHMARKS / benchmark, "--small"],
        capture_output=True,
        text=True,
        timeout=250,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert says in done.stdout
