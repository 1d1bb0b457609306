"""The same phase sweep through the emulated board and through the firmware in gpsim.

The whole chain in lock step, `usmbench sweep` as a user runs it: driver, pseudo-terminal, board,
AD9833 models, motor, encoder, card, run folder. Both runs start from the same seed, and their pairs
must be the same to what the encoder resolves; exits 1 where they are not.

``python benchmarks/firmware_sweep.py``; build the image with `make -C firmware`. ``--small`` takes
a shorter plan.
"""

import argparse
import csv
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import yaml

from usmbench.cli.simulated_bench import start_testbed

# The image acts up to 30 µs before or after the emulated board, by what its main loop is at. What
# that changes must stay below what the encoder resolves of one window at full speed, 0.005 %.
SPEED_TOLERANCE_RAD_S = 5e-4
SWEEP_TIMEOUT_S = 900.0
EXACT = ("phase_deg", "frequency_hz", "torque_nm", "direction", "n_windows")
SMALL_PLAN = {
    "format": "usmbench-plan/1",
    "name": "short",
    "description": "A few phases, up and down.",
    "frequency_hz": 41_000,
    "warm_up": {"phase_deg": 90, "duration_s": 0.2},
    "passes": [{"phase_deg": [-90, 0, 45, 90], "direction": "rising"}],
    "dwell": {"windows": 20},
}


def sweep(board: str, plan: str, folder: Path) -> list[dict[str, str]]:
    """Run the sweep on a fresh testbed with this board; return its pairs."""
    run = folder / board
    with start_testbed(["--board", board, "--lock-step", "--seed", "3"]) as testbed:
        bench = {
            "format": "usmbench-bench/1",
            "generator": {"port": testbed.port, "reply_timeout_s": 2.0},
            "daq": {
                "address": testbed.daq_address,
                "no_data_timeout_s": 10.0,
            },
        }
        bench_file = folder / f"{board}.yaml"
        bench_file.write_text(yaml.safe_dump(bench))
        command = [sys.executable, "-m", "usmbench", "sweep", plan]
        done = subprocess.run(
            [*command, "--bench", str(bench_file), "--out", str(run)],
            capture_output=True,
            text=True,
            timeout=SWEEP_TIMEOUT_S,
            check=False,
        )
    if done.returncode:
        raise SystemExit(f"sweep with the {board} board: {done.stderr}")
    with (run / "pairs.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def compare(emulated: list[dict[str, str]], image: list[dict[str, str]]) -> float:
    """Return the largest difference in speed; leave where anything else differs."""
    if len(emulated) != len(image) or not emulated:
        raise SystemExit(f"{len(emulated)} pairs with the emulated board, {len(image)} with gpsim")
    for ours, theirs in zip(emulated, image, strict=True):
        differing = [name for name in EXACT if float(ours[name]) != float(theirs[name])]
        if differing:
            raise SystemExit(f"{differing} differ: {ours} {theirs}")
    return max(
        abs(float(ours["speed_rad_s"]) - float(theirs["speed_rad_s"]))
        for ours, theirs in zip(emulated, image, strict=True)
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--small", action="store_true", help="a shorter plan")
    small = parser.parse_args().small
    with tempfile.TemporaryDirectory() as directory:
        folder = Path(directory)
        plan = "phase-sweep"
        if small:
            (folder / "short.yaml").write_text(yaml.safe_dump(SMALL_PLAN))
            plan = str(folder / "short.yaml")
        pairs = {}
        for board in ("emulated", "gpsim"):
            began_s = time.monotonic()
            pairs[board] = sweep(board, plan, folder)
            print(f"{board}: {len(pairs[board])} pairs in {time.monotonic() - began_s:.0f} s")
    worst_rad_s = compare(pairs["emulated"], pairs["gpsim"])
    same = sum(a == b for a, b in zip(pairs["emulated"], pairs["gpsim"], strict=True))
    spread_rad_s = max(float(pair["speed_std_rad_s"]) for pair in pairs["emulated"])
    print(
        f"phases, frequencies, windows equal; {same} speeds equal to the last digit, all within "
        f"{worst_rad_s:.2g} rad/s (a window's standard deviation is up to {spread_rad_s:.2g})"
    )
    return 0 if worst_rad_s <= SPEED_TOLERANCE_RAD_S else 1


if __name__ == "__main__":
    sys.exit(main())
