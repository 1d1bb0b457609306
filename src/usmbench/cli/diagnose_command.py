"""``usmbench diagnose``: what the simulation gets wrong, why, and what it gains to know."""

import argparse
import sys
from pathlib import Path

from usmbench.cli.json_output import write_json
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.result import Diagnosis
from usmbench.model.model_file import read_model, write_model
from usmbench.runs.reader import read_run


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


def run(args: argparse.Namespace) -> int:
    """Diagnose, write what was asked for, and say what was found.

    Parameters
    ----------
    args
        The parsed arguments.

    Raises
    ------
    usmbench.errors.InputError
        A run or the model will not do.
    """
    model = read_model(args.model)
    records = [read_run(path) for path in args.runs]
    result = diagnose(records, model)
    for warning in result.warnings:
        print(f"usmbench: warning: {warning}", file=sys.stderr)
    if args.out is not None:
        write_model(args.out, result.extended)
    if args.report is not None:
        from usmbench.report.diagnosis_page import write_diagnosis_page

        write_diagnosis_page(args.report, result, records, model, args.model)
    if args.json:
        write_json(args.json, result.to_json())
    if args.json != "-":
        print(_lines(result))
    return 0


def _lines(result: Diagnosis) -> str:
    """Say what was found."""
    lines = [f"verdict    {result.verdict}"]
    for cause in result.causes:
        sizes = ", ".join(
            f"{p.name} {p.value:.4g} ({p.low:.4g} … {p.high:.4g})" for p in cause.parameters
        )
        lines.append(f"cause      {cause.name}{': ' + sizes if sizes else ''}")
        lines.append(f"           {cause.meaning}")
        lines.append(f"           {cause.mend}")
        if cause.alternatives:
            lines.append(f"           cannot be told from {', '.join(cause.alternatives)}")
    lines.append(
        f"RMSE       {result.rmse_simulation_rad_s:.4g} rad/s, extended "
        f"{result.rmse_extended_rad_s:.4g}, noise {result.noise_floor_rad_s:.4g} (held out)"
    )
    if result.causes:
        lines.append(
            f"gain       {result.gain:.3f} ({result.gain_low:.3f} … {result.gain_high:.3f})"
        )
    if result.remainder is not None:
        lines.append(f"remainder  {result.remainder.says}")
    for name, reason in result.not_testable:
        lines.append(f"not tested {name}: {reason}")
    return "\n".join(lines)
