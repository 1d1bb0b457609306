"""`usmbench demo`: all of it on the simulated testbed."""

import argparse
import shutil
import sys
from pathlib import Path

from usmbench.cli.bench_session import SIMULATED, open_bench
from usmbench.cli.live_panel import LivePanel
from usmbench.cli.main import main
from usmbench.cli.sweep_run import sweep_new
from usmbench.errors import BenchError, InputError
from usmbench.model.model_file import read_model
from usmbench.runs.meta import read_meta
from usmbench.runs.reader import read_run
from usmbench.settings.plan_file import load_plan
from usmbench.sweep.interrupts import deferred_interrupts
from usmbench.sweep.preflight import interlocks_of

PLAN = "phase-sweep"
# Two runs of one motor: the noise of the second is another one.
RUN_SEEDS = {"reference": 1, "measured": 2}
WRITTEN = ("model.yaml", "curve.png", "replay.png")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments.

    Parameters
    ----------
    parser
        The subcommand's parser.
    """
    parser.add_argument("--out", type=Path, default=Path("demo"), metavar="DIR", help="[demo]")


def run(args: argparse.Namespace) -> int:
    """Sweep twice, identify the first run, replay the second, and draw both.

    Parameters
    ----------
    args
        The parsed arguments.

    Raises
    ------
    usmbench.errors.InputError
        The folder holds something that no demo has written.
    usmbench.errors.BenchError
        The simulated testbed failed.
    """
    folder: Path = args.out
    _make_room(folder)
    reference, measured = (_measure(folder / name, RUN_SEEDS[name]) for name in RUN_SEEDS)
    model = folder / "model.yaml"
    _step("identify", str(reference), "--out", str(model))
    _draw_curve(folder / "curve.png", reference, model)
    plot = folder / "replay.png"
    _step("replay", str(measured), "--model", str(model), "--plot", str(plot))
    print(f"\nLook at {folder / 'curve.png'} and {plot}.")
    return 0


def _make_room(folder: Path) -> None:
    """Remove what an earlier demo left, and nothing else."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise InputError("is no folder; name another with --out", file=folder)
    ours = {*RUN_SEEDS, *WRITTEN}
    foreign = sorted(entry.name for entry in folder.iterdir() if entry.name not in ours)
    if foreign:
        raise InputError(f"holds {foreign[0]}, which no demo wrote; name another", file=folder)
    for name in RUN_SEEDS:
        run_folder = folder / name
        if run_folder.exists():
            read_meta(run_folder)  # refuses what is no run folder
            shutil.rmtree(run_folder)


def _measure(folder: Path, seed: int) -> Path:
    """Drive the shipped plan on the embedded testbed."""
    print(f"\n$ usmbench sweep {PLAN} --bench {SIMULATED} --seed {seed} --out {folder}", flush=True)
    arguments = ["--seed", str(seed)]
    with (
        deferred_interrupts(),
        open_bench(SIMULATED, testbed_arguments=arguments) as bench,
    ):
        plan = load_plan(PLAN)
        with LivePanel(
            sys.stderr, f"{PLAN} → {folder}", interlocks_of(plan, bench.settings)
        ) as panel:
            sweep_new(bench, plan, folder, meta={"seed": seed}, observer=panel)
    print(folder, flush=True)
    return folder


def _step(*words: str) -> None:
    """Run another subcommand as a user would type it."""
    print(f"\n$ usmbench {' '.join(words)}", flush=True)
    status = main(words)
    if status:
        raise BenchError(f"the demo ends here: `usmbench {words[0]}` returned {status}")


def _draw_curve(file: Path, reference: Path, model: Path) -> None:
    from usmbench.report.curve_plot import write_curve_plot

    pairs = read_run(reference).pairs
    if pairs is None:
        raise BenchError(f"{reference} has no settled pairs; nothing can be drawn")
    write_curve_plot(file, pairs, read_model(model).points[0])
