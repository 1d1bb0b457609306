"""``usmbench identify``: from runs to a model."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from usmbench.cli.json_output import write_json
from usmbench.diagnose.reference import with_knowledge
from usmbench.errors import InputError
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.paper import PaperOptions, identify_paper
from usmbench.identify.result import Identification
from usmbench.model.model_file import write_model
from usmbench.output import warn
from usmbench.report.identification_table import identification_table
from usmbench.report.search_trace import write_trace
from usmbench.runs.output_paths import check_outputs
from usmbench.runs.reader import read_run
from usmbench.runs.record import Record
from usmbench.runs.unsaid_points import as_the_others

_HIGHEST_ORDER = 20  # the search of more does not end


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments.

    Parameters
    ----------
    parser
        The subcommand's parser.
    """
    parser.add_argument("runs", nargs="+", metavar="RUN", type=Path, help="run folder or CSV")
    parser.add_argument("--out", required=True, type=Path, metavar="MODEL.yaml")
    parser.add_argument("--method", choices=["fast", "paper"], default="fast")
    parser.add_argument("--degree", type=int, help="degree of the curve")
    parser.add_argument("--knots", metavar="a,b,…", help="knots in degrees, rising")
    parser.add_argument("--na", type=int, default=1, help="past speeds in the dynamics")
    parser.add_argument("--nb", type=int, help="past inputs in the dynamics")
    parser.add_argument("--seed", type=int, help="paper: seed of the random start [0]")
    parser.add_argument(
        "--trace", type=Path, metavar="FILE.csv", help="paper: SSE, μ and λ of every iteration"
    )
    parser.add_argument("--json", metavar="FILE", help="figures as JSON; - is standard output")


def run(args: argparse.Namespace) -> int:
    """Identify, write the model, and say how it went.

    Parameters
    ----------
    args
        The parsed arguments.

    Raises
    ------
    InputError
        A run, an argument, an output file or the data will not do.
    """
    _check(args)
    outputs = {"--out": args.out, "--trace": args.trace, "--json": args.json}
    check_outputs(outputs, args.runs)
    # In one order whichever they are given in: where a search ends may hang on it.
    said = [read_run(path) for path in sorted(args.runs, key=lambda run: (run.name, run))]
    records, warnings = as_the_others(said)
    found = _identify(args, records)
    write_model(args.out, with_knowledge(found.model, records))
    warn((*warnings, *found.warnings))
    if args.json:
        write_json(args.json, found.to_json())
    if args.json != "-":
        print(identification_table(found))
        print(f"model written to {args.out}")
    return 0


def _check(args: argparse.Namespace) -> None:
    """Refuse orders and degrees that are none."""
    for name, lowest in (("degree", 1), ("na", 0), ("nb", 0)):
        value = getattr(args, name)
        if value is not None and value < lowest:
            raise InputError(f"--{name} {value} is too low; give {lowest} or more")
        if name != "degree" and value is not None and value > _HIGHEST_ORDER:
            raise InputError(f"--{name} {value} is too high; give {_HIGHEST_ORDER} or less")
    if args.method != "paper" and (args.seed is not None or args.trace is not None):
        raise InputError("--seed and --trace belong to --method paper; the default draws nothing")
    if args.seed is not None and args.seed < 0:
        raise InputError(f"--seed {args.seed} is negative; give 0 or more")
    if args.degree is not None and args.knots is not None:
        raise InputError("--degree and --knots say the same twice; give one of them")


def _identify(args: argparse.Namespace, records: Sequence[Record]) -> Identification:
    """Identify by the method asked for."""
    knots_deg = _knots(args.knots)
    if args.method == "paper":
        nb, seed = args.nb or 0, args.seed or 0
        options = PaperOptions(args.degree, knots_deg, args.na, nb, seed)
        by_paper = identify_paper(records, options)
        if args.trace is not None:
            write_trace(args.trace, by_paper.result.trace)
        return by_paper.found
    return identify_fast(records, FastOptions(args.degree, knots_deg, args.na, args.nb))


def _knots(text: str | None) -> tuple[float, ...] | None:
    """Parse the list of knots."""
    if text is None:
        return None
    try:
        return tuple(float(word) for word in text.split(","))
    except ValueError:
        raise InputError(f"--knots {text!r} is no list of numbers; give a,b,… in degrees") from None
