"""``usmbench diagnose``: what the simulation gets wrong, why, and what it gains to know."""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import yaml

from usmbench.cli.deciding_runs import Judged, check_bench, decide, judge
from usmbench.cli.diagnosis_lines import diagnosis_lines
from usmbench.cli.each_run import Entry, diagnose_each, each_table, each_warnings
from usmbench.cli.executors import all_cores, cluster
from usmbench.cli.json_output import write_json
from usmbench.cli.runs_folder import RUNS_FOLDER
from usmbench.diagnose.result import Diagnosis
from usmbench.errors import InputError
from usmbench.model.effects.registry import library
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.model_file import read_model, write_model
from usmbench.output import complain, warn
from usmbench.runs.output_files import write_output
from usmbench.runs.output_paths import check_outputs
from usmbench.runs.reader import read_run

_BUDGET = 3


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments.

    Parameters
    ----------
    parser
        The subcommand's parser.
    """
    parser.add_argument("runs", nargs="+", metavar="RUN", type=Path, help="run folder or CSV")
    parser.add_argument("--model", required=True, type=Path, metavar="MODEL.yaml")
    parser.add_argument("--out", type=Path, metavar="EXTENDED.yaml", help="the extended model")
    parser.add_argument("--json", metavar="FILE", help="result as JSON; - is standard output")
    parser.add_argument("--report", type=Path, metavar="FILE.html", help="a page that shows it all")
    parser.add_argument(
        "--next", type=Path, metavar="PLAN.yaml", help="the next experiment, as a plan for sweep"
    )
    parser.add_argument(
        "--bench",
        metavar="BENCH.yaml",
        help="run the next experiment there, and the next, until one cause is left",
    )
    parser.add_argument(
        "--budget", type=int, metavar="N", help=f"most experiments to run [{_BUDGET}]"
    )
    parser.add_argument(
        "--runs-folder", type=Path, metavar="DIR", help="folder for their runs [runs]"
    )
    parser.add_argument(
        "--each", action="store_true", help="every run on its own, over all cores; one line a run"
    )
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="the same over the Dask cluster of this scheduler"
    )


def run(args: argparse.Namespace) -> int:
    """Diagnose, decide where a bench is given, write what was asked for, say what was found.

    Parameters
    ----------
    args
        The parsed arguments.

    Raises
    ------
    usmbench.errors.InputError
        A run, the model, the bench, an output file or the arguments will not do.
    KeyboardInterrupt
        The user stopped an experiment; the drive is off and the run folder closed.
    usmbench.errors.BenchError
        The bench failed; likewise.
    """
    budget = _checked_budget(args)
    _check_outputs(args)
    if args.each or args.scheduler is not None:
        return _run_each(args)
    model, records = read_model(args.model), [read_run(path) for path in args.runs]
    runs = args.runs_folder or RUNS_FOLDER
    if args.bench is not None:
        warn(check_bench(records, args.bench, runs))
    judged = judge(records, model)
    _say(args, judged)
    try:
        if args.bench is not None:
            for after in _decided(judged, model, args, budget, runs):
                judged = after
                _say(args, judged)
    finally:
        # What is known by now must not be lost with the bench, or where the user has had enough.
        _write(args, judged, model)
    return 0


def _check_outputs(args: argparse.Namespace) -> None:
    """Refuse files that cannot be written, and what would cost data."""
    names = ("out", "json", "report", "next")
    outputs = {f"--{name}": getattr(args, name) for name in names}
    check_outputs(outputs, [*args.runs, args.model, args.bench])


def _decided(
    judged: Judged, model: HammersteinModel, args: argparse.Namespace, budget: int, runs: Path
) -> Iterator[Judged]:
    """Yield a judgement after each experiment, and say what ends them."""
    n_driven = 0
    for after in decide(judged, model, args.bench, budget, runs):
        judged, n_driven = after, n_driven + 1
        if args.json != "-":
            print(f"\ndriven     {judged.records[-1].name}\n")
        yield judged
    if judged.diagnosis.next_experiment is not None:
        ended = f"the budget of {budget} experiments is used"
    elif n_driven == 0:
        ended = "no experiment was driven, since none is proposed"
    else:
        ended = "no further experiment is proposed"
    complain(f"usmbench: {ended}")


def _say(args: argparse.Namespace, judged: Judged) -> None:
    """Say what was found, unless standard output is for the JSON alone."""
    warn(judged.diagnosis.warnings)
    if args.json != "-":
        print(diagnosis_lines(judged.diagnosis), flush=True)


def _run_each(args: argparse.Namespace) -> int:
    """Diagnose every run on its own, on this machine or a cluster; say what was found of each."""
    for name in ("out", "report", "next", "bench"):
        if getattr(args, name) is not None:
            raise InputError(f"--{name} is for one diagnosis; with --each there is one a run")
    model = read_model(args.model)
    library()  # what is wrong with a cause is no run's fault
    entries: list[Entry] = [{}] * len(args.runs)
    with all_cores() if args.scheduler is None else cluster(args.scheduler) as executor:
        found = diagnose_each(args.runs, model, executor)
        for n_done, (place, entry) in enumerate(found, 1):
            entries[place] = entry
            if sys.stderr.isatty():
                print(f"\r{n_done} of {len(entries)} runs", end="", file=sys.stderr, flush=True)
    if sys.stderr.isatty():
        print(file=sys.stderr)
    warn(each_warnings(entries))
    if args.json:
        write_json(args.json, {"runs": entries})
    if args.json != "-":
        print(each_table(entries))
    n_failed = sum("error" in entry for entry in entries)
    if n_failed:
        raise InputError(f"{n_failed} of {len(entries)} runs were not judged; their lines say why")
    return 0


def _checked_budget(args: argparse.Namespace) -> int:
    """Refuse arguments that mean nothing together; return how many experiments may be run."""
    if args.bench is None:
        for name in ("budget", "runs_folder"):
            if getattr(args, name) is not None:
                shown = name.replace("_", "-")
                raise InputError(f"--{shown} is for experiments; name their bench with --bench")
    budget = _BUDGET if args.budget is None else int(args.budget)
    if budget < 1:
        raise InputError(f"a budget of {budget} experiments runs none; choose at least 1")
    return budget


def _write(args: argparse.Namespace, judged: Judged, model: HammersteinModel) -> None:
    """Write the files that were asked for."""
    found = judged.diagnosis
    if args.out is not None:
        write_model(args.out, found.extended)
    if args.next is not None:
        _write_plan(args.next, found)
    if args.report is not None:
        from usmbench.report.diagnosis_page import write_diagnosis_page

        write_diagnosis_page(
            args.report, found, judged.records, model, args.model, driven=judged.driven
        )
    if args.json:
        write_json(args.json, found.to_json())


def _write_plan(file: Path, found: Diagnosis) -> None:
    """Write the next experiment, or say that there is none."""
    if found.next_experiment is None:
        complain(
            "usmbench: no experiment is proposed: nothing is open, or no plan within the phases, "
            f"frequencies and torques that the model knows would decide; {file} is not written"
        )
        return
    plan = yaml.safe_dump(found.next_experiment["plan"], sort_keys=False, width=100)
    write_output(file, f"# {found.next_experiment['says']}\n{plan}")
