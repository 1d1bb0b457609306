"""``usmbench sweep``: drive the testbed through a plan and write a run folder."""

import argparse
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TextIO

from usmbench.cli.bench_session import open_bench, settings_of
from usmbench.cli.live_panel import LivePanel
from usmbench.cli.runs_folder import check_absent, named_at_the_end, new_run_folder
from usmbench.cli.same_bench import check_same_bench
from usmbench.cli.simulated_motor import SimulatedMotor
from usmbench.cli.sweep_run import sweep_again, sweep_new
from usmbench.errors import InputError
from usmbench.instruments.frame_log import log_error
from usmbench.report.plain_text import file_name, printable
from usmbench.runs.columns import RUN_FILE
from usmbench.runs.meta import read_meta
from usmbench.runs.output_files import cannot_write
from usmbench.runs.output_paths import check_outputs
from usmbench.runs.run_lock import check_free
from usmbench.runs.stop_point import stop_point
from usmbench.settings.bench import SIMULATED, BenchSettings
from usmbench.settings.bench_file import parse_bench
from usmbench.settings.plan import Plan
from usmbench.settings.plan_file import load_plan, parse_plan, shipped_plans
from usmbench.settings.yaml_source import Source
from usmbench.sweep.interrupts import deferred_interrupts
from usmbench.sweep.preflight import check_plan, interlocks_of
from usmbench.sweep.summary import describe


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments.

    Parameters
    ----------
    parser
        The subcommand's parser.
    """
    parser.add_argument(
        "plan",
        metavar="PLAN.yaml",
        nargs="?",
        help=f"plan file, or a plan that ships: {', '.join(shipped_plans())}",
    )
    parser.add_argument("--bench", metavar="BENCH.yaml", help=f"bench file, or {SIMULATED}")
    parser.add_argument("--out", type=Path, metavar="DIR", help="run folder to make [runs/…]")
    parser.add_argument("--dry-run", action="store_true", help="show passes, limits and duration")
    parser.add_argument("--resume", type=Path, metavar="RUN", help="take up an interrupted run")
    parser.add_argument("--raw", action="store_true", help="keep the counter samples in raw.h5")
    parser.add_argument("--seed", type=int, metavar="N", help=f"seed of the {SIMULATED} bench")
    parser.add_argument(
        "--defect",
        action="append",
        default=[],
        metavar="MECHANISM[=SIZE]",
        help=f"something wrong with the motor of the {SIMULATED} bench (python -m hil_sim --help)",
    )
    parser.add_argument(
        "--model",
        metavar="MODEL.yaml",
        help=f"the motor of the {SIMULATED} bench as a model file says, without noise",
    )
    parser.add_argument(
        "--frame-log", type=Path, metavar="FILE", help="log every frame on the line"
    )


def run(args: argparse.Namespace) -> int:
    """Drive a plan, or take up a run again.

    Parameters
    ----------
    args
        The parsed arguments.

    Raises
    ------
    usmbench.errors.InputError
        The arguments, the plan or the bench are wrong; nothing has moved.
    KeyboardInterrupt
        The user stopped the run; the drive is off and the folder closed.
    usmbench.errors.BenchError
        The bench failed; likewise.
    """
    _check_arguments(args)
    check_outputs({"--frame-log": args.frame_log}, [args.plan, args.bench, args.model])
    if args.resume is not None:
        return _resume(args)
    plan = load_plan(args.plan)
    settings = settings_of(args.bench or SIMULATED)
    check_plan(plan, settings)
    if args.dry_run:
        for line in describe(plan, settings, interlocks_of(plan, settings)):
            print(printable(line))
        return 0
    folder = args.out or new_run_folder(file_name(plan.name))
    check_absent(folder)
    return _drive(args, args.bench, plan, folder)


def _check_arguments(args: argparse.Namespace) -> None:
    """Refuse arguments that do not go together."""
    if args.resume is not None:
        for name in ("plan", "out", "raw", "seed", "defect", "dry_run"):
            if _is_given(args, name):
                shown = "PLAN.yaml" if name == "plan" else f"--{name.replace('_', '-')}"
                raise InputError(f"--resume takes this from the run: leave {shown} out")
        return
    if args.plan is None:
        raise InputError("no plan was named; give a plan file, or --resume RUN")
    if args.bench is None and not args.dry_run:
        raise InputError(f"no bench was named; give --bench BENCH.yaml or --bench {SIMULATED}")
    for name in ("seed", "defect", "model"):
        if _is_given(args, name) and args.bench != SIMULATED:
            raise InputError(f"--{name} is for --bench {SIMULATED}; leave it out")


def _is_given(args: argparse.Namespace, name: str) -> bool:
    value = getattr(args, name)
    # A seed of 0 is given, and equals False.
    return value is not None and value is not False and value != []


def _drive(args: argparse.Namespace, bench: str | BenchSettings, plan: Plan, folder: Path) -> int:
    """Open the bench and drive the plan, anew or again."""
    motor = SimulatedMotor(args.seed, tuple(args.defect), args.model)
    # The guard reaches round the bench: closing it must not be cut short either.
    with (
        _frame_log(args.frame_log) as log,
        deferred_interrupts() as interrupts,
        open_bench(bench, testbed_arguments=motor.arguments, frame_log=log) as opened,
    ):
        interrupts.check()
        limits = interlocks_of(plan, opened.settings)
        with (
            named_at_the_end(folder),
            LivePanel(sys.stderr, f"{plan.name} → {folder}", limits) as panel,
        ):
            if args.resume is not None:
                sweep_again(opened, plan, folder, observer=panel)
            else:
                sweep_new(opened, plan, folder, raw=args.raw, meta=motor.meta, observer=panel)
    return 0


def _resume(args: argparse.Namespace) -> int:
    folder: Path = args.resume
    meta = read_meta(folder)
    if meta.get("exit") == "completed":
        raise InputError("the run is complete, there is nothing to resume", file=folder)
    check_free(folder)
    plan = parse_plan(_part(folder, meta, "plan"))
    if args.bench is not None:
        check_same_bench(folder, meta, args.bench, settings_of(args.bench))
    bench: str | BenchSettings = args.bench or parse_bench(_part(folder, meta, "bench"))
    if isinstance(bench, BenchSettings) and bench.name == SIMULATED:
        bench = SIMULATED
    stop_point(folder)
    # The same noise twice in a run would look like a cause.
    motor = SimulatedMotor()
    if bench == SIMULATED:
        motor = SimulatedMotor.of_run(meta, later=1, model=args.model)
    elif args.model is not None:
        raise InputError(f"--model is for --bench {SIMULATED}; leave it out")
    args.seed, args.defect = motor.seed, motor.defects
    return _drive(args, bench, plan, folder)


def _part(folder: Path, meta: dict[str, Any], key: str) -> Source:
    """Return the plan or the bench of a run."""
    if key not in meta:
        message = f"has no {key}: only a run that sweep measured can be resumed"
        raise InputError(message, file=folder / RUN_FILE)
    return Source(f"{folder / RUN_FILE} ({key})", meta[key])


@contextmanager
def _frame_log(file: Path | None) -> Iterator[TextIO | None]:
    if file is None:
        yield None
        return
    try:
        log = file.open("w", encoding="utf-8")
    except OSError as error:
        raise cannot_write(file, error) from error
    try:
        yield log
    except BaseException:
        with suppress(OSError):  # what ended the sweep is the error to be seen
            log.close()
        raise
    try:
        log.close()
    except OSError as error:
        raise log_error(log, error) from error
