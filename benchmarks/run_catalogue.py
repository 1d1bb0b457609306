"""What `usmbench runs` costs on a folder of many runs: to list, to find, to hold to check sums.

    python benchmarks/run_catalogue.py [--small]

The runs are of the four plans that ship, each with its own id, start and end, in the system's
folder for temporary files, or in --folder. The whole command is timed, from the shell's side.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from usmbench.runs.meta import sha256_of
from usmbench.runs.writer import RunWriter
from usmbench.settings.bench import BenchSettings
from usmbench.settings.bench_file import bench_document
from usmbench.settings.plan_file import load_plan, shipped_plans
from usmbench.sweep.rows import WindowRow

ALLOWED_S = 2.0
OUTCOMES = ("completed", "completed", "completed", "interrupted", "failed: the card gave no data")
ROW = WindowRow(0.01, 90.0, 9.0, 41e3, 0.0, 0.09, 0.01, 0, 1, 9.0, 1)


def make_runs(folder: Path, n_runs: int) -> None:
    """Make run folders that differ in what run.yaml says.

    Parameters
    ----------
    folder
        Where to make them, in folders of a hundred.
    n_runs
        How many.
    """
    documents = [load_plan(name).source.document for name in shipped_plans()]
    patterns = [_pattern(folder / f"pattern-{i}", plan) for i, plan in enumerate(documents)]
    first = datetime(2026, 1, 1, tzinfo=UTC)
    for number in range(n_runs):
        started = first + timedelta(minutes=20 * number)
        text, windows = patterns[number % len(patterns)]
        head = f"format: usmbench-run/1\nid: r{number:06d}\nstarted: '{started.isoformat()}'\n"
        tail = f"exit: '{OUTCOMES[number % len(OUTCOMES)]}'\n"
        run = folder / f"{number // 100:03d}" / f"{number:06d}"
        run.mkdir(parents=True)
        (run / "run.yaml").write_text(head + text + tail, encoding="utf-8")
        (run / "windows.csv").write_bytes(windows)


def _pattern(folder: Path, plan: dict[str, Any]) -> tuple[str, bytes]:
    """Return what run.yaml says of one plan between its head and its exit, and the data."""
    bench = BenchSettings()
    meta = {"motor": bench.motor, "bench": bench_document(bench), "plan": plan}
    writer = RunWriter.create(folder, meta, temperature=False, raw=False)
    writer.window(ROW)
    writer.close("completed")
    kept = [
        line
        for line in (folder / "run.yaml").read_text(encoding="utf-8").splitlines(keepends=True)
        if not line.startswith(("format:", "id:", "started:", "exit:", "  pairs.csv:"))
    ]
    data = (folder / "windows.csv").read_bytes()
    assert sha256_of(folder / "windows.csv") in "".join(kept)
    for file in folder.iterdir():
        file.unlink()
    folder.rmdir()
    return "".join(kept), data


def timed(*words: str) -> tuple[float, str]:
    """Run the command; return its wall time and what it said last.

    Parameters
    ----------
    *words
        Its arguments.
    """
    begin_s = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "usmbench", "runs", *words],
        capture_output=True,
        text=True,
        check=True,
    )
    return time.perf_counter() - begin_s, done.stdout.splitlines()[-1]


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--small", action="store_true", help="500 runs, not 10 000")
    parser.add_argument("--folder", type=Path, help="where to make the runs")
    options = parser.parse_args(arguments)
    slowest_s = 0.0
    with tempfile.TemporaryDirectory(dir=options.folder) as parent:
        make_runs(Path(parent), 500 if options.small else 10_000)
        questions = {
            "list": (),
            "find by plan.name": ("--find", "plan.name=tele*"),
            "find by bench.daq.family and exit": (
                *("--find", "bench.daq.family=m_x"),
                *("--find", "exit=failed*"),
            ),
        }
        for name, words in questions.items():
            wall_s, said = min(timed(parent, *words) for _ in range(3))
            slowest_s = max(slowest_s, wall_s)
            print(f"{name}: {said} in {wall_s:.2f} s (allowed {ALLOWED_S:g})")
        wall_s, said = timed(parent, "--check")
        print(f"list and check: {said} in {wall_s:.2f} s")
    return int(slowest_s > ALLOWED_S)


if __name__ == "__main__":
    sys.exit(main())
