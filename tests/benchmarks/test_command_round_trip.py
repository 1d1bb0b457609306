"""The small version of the round trip: the emulated board takes the time of the line."""

import re
import subprocess
import sys
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "benchmarks" / "command_round_trip.py"


def test_a_round_trip_takes_at_least_the_time_of_its_bytes() -> None:
    """How much more it takes depends on the machine's load; the benchmark itself judges that."""
    done = subprocess.run(
        [sys.executable, SCRIPT, "--small"], capture_output=True, text=True, timeout=60
    )
    assert done.stderr == ""
    ratio = re.search(r"median ratio (\d+\.\d+)", done.stdout)
    assert ratio is not None, done.stdout
    assert 0.99 <= float(ratio.group(1)) < 20.0
