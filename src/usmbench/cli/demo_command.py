"""`usmbench demo`: all of it on the simulated testbed."""

import argparse
import json
import random
import shutil
from pathlib import Path
from typing import Any

from usmbench.cli.main import main
from usmbench.errors import BenchError, InputError
from usmbench.model.model_file import read_model
from usmbench.report.numbers_text import percent
from usmbench.runs.meta import read_meta
from usmbench.runs.reader import read_run
from usmbench.settings.bench import SIMULATED
from usmbench.settings.plan_file import load_plan

PLAN = "phase-sweep"
RUNS = ("reference", "measured")
WRITTEN = ("model.yaml", "extended.yaml", "report.html", "diagnosis.json", "curve.png")
# What is done to the motor between the two runs, and the cause it shows as; all in the testbed's
# terms (`python -m hil_sim --help`).
HIDDEN = {
    "amplifier_delay=40": "phase_offset",
    "leaning_teeth=3": "gain_asymmetry",
    "worn_contact=3": "speed_scale",
    "eccentric_disc=150": "encoder_eccentricity",
    "command_queue=12": "transport_delay",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments.

    Parameters
    ----------
    parser
        The subcommand's parser.
    """
    parser.add_argument("--out", type=Path, default=Path("demo"), metavar="DIR", help="[demo]")
    parser.add_argument(
        "--seed", type=int, default=1, metavar="N", help="draws what is hidden, and the noise [1]"
    )


def run(args: argparse.Namespace) -> int:
    """Sweep, identify, hide something, sweep again, and have it found.

    Parameters
    ----------
    args
        The parsed arguments.

    Raises
    ------
    usmbench.errors.InputError
        The folder cannot be made, or holds something that no demo has written.
    usmbench.errors.BenchError
        The simulated testbed failed.
    """
    if args.seed < 0:
        raise InputError(f"the seed must be 0 or more, not {args.seed}")
    folder: Path = args.out
    _make_room(folder)
    reference, measured = (folder / name for name in RUNS)
    model, extended, report, found, curve = (folder / name for name in WRITTEN)
    # Two runs of one motor: the noise of the second is another one.
    _sweep(reference, 2 * args.seed)
    _step("identify", reference, "--out", model)
    _draw_curve(curve, reference, model)
    hidden = random.Random(args.seed).choice(sorted(HIDDEN))  # noqa: S311 - a draw, no secret
    _sweep(measured, 2 * args.seed + 1, hidden)
    outputs = ("--out", extended, "--report", report, "--json", found)
    _step("diagnose", measured, "--model", model, *outputs)
    print(f"\n{_comparison(hidden, json.loads(found.read_text('utf-8')))}")
    print(f"Look at {report} and {curve}.")
    return 0


def _make_room(folder: Path) -> None:
    """Make the folder, or remove what an earlier demo left in it, and nothing else."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"cannot be made: {error.strerror}; name another folder with --out"
        raise InputError(message, file=folder) from error
    ours = {*RUNS, *WRITTEN}
    foreign = sorted(entry.name for entry in folder.iterdir() if entry.name not in ours)
    if foreign:
        raise InputError(f"holds {foreign[0]}, which no demo wrote; name another", file=folder)
    old = [folder / name for name in RUNS if (folder / name).exists()]
    for run_folder in old:
        _check_ours(run_folder)
    for run_folder in old:
        shutil.rmtree(run_folder)


def _check_ours(run_folder: Path) -> None:
    """Refuse what is no run of a demo: what was measured cannot be had again."""
    meta = read_meta(run_folder)
    bench = meta.get("bench")
    simulated = isinstance(bench, dict) and bench.get("name") == SIMULATED
    same_plan = simulated and meta.get("plan") == load_plan(PLAN).source.document
    if not same_plan or run_folder.is_symlink():
        raise InputError("is a run that no demo drove; name another with --out", file=run_folder)


def _sweep(folder: Path, seed: int, hidden: str | None = None) -> None:
    """Drive the shipped plan on the embedded testbed; what is hidden is not told yet."""
    words = ("sweep", PLAN, "--bench", SIMULATED, "--seed", seed, "--out", folder)
    if hidden is None:
        _step(*words)
    else:
        _step(*words, untold=("--defect", hidden))


def _step(*words: object, untold: tuple[str, ...] = ()) -> None:
    """Run another subcommand as a user would type it."""
    typed = [str(word) for word in words]
    print(f"\n$ usmbench {' '.join(typed)}{' --defect …' if untold else ''}", flush=True)
    status = main([*typed, *untold])
    if status:
        ends = BenchError(f"the demo ends here: `usmbench {typed[0]}` returned {status}")
        ends.exit_status = status
        raise ends


def _comparison(hidden: str, found: dict[str, Any]) -> str:
    """Say what was hidden beside what was found."""
    names = ", ".join(cause["name"] for cause in found["causes"])
    hid = f"Hidden in the second run: {hidden}, which shows as {HIDDEN[hidden]}.\n"
    if not names:
        return f"{hid}Found: no cause."
    removed = percent(found["gain"])
    return (
        f"{hid}Found: {names}; knowing it removes {removed} of the held-out error above the noise."
    )


def _draw_curve(file: Path, reference: Path, model: Path) -> None:
    from usmbench.report.curve_plot import write_curve_plot

    pairs = read_run(reference).pairs
    if pairs is None:
        raise BenchError(f"{reference} has no settled pairs; nothing can be drawn")
    write_curve_plot(file, pairs, read_model(model).points[0])
