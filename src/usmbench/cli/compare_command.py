"""``usmbench compare``: two runs, setting by setting."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from usmbench.cli.json_output import write_json
from usmbench.cli.plot_argument import add_plot_argument
from usmbench.errors import InputError
from usmbench.output import warn
from usmbench.report.plain_text import printable
from usmbench.report.plot_format import plot_format
from usmbench.runs.check_record import changed_since_closed
from usmbench.runs.comparison import Comparison, compare_pairs, differing_keys
from usmbench.runs.output_paths import check_outputs
from usmbench.runs.reader import read_run
from usmbench.runs.record import Pairs, Record

_KEYS_SHOWN = 12
_VALUE_WIDTH = 40


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments.

    Parameters
    ----------
    parser
        The subcommand's parser.
    """
    parser.add_argument("first", metavar="RUN", type=Path, help="run folder or CSV")
    parser.add_argument("second", metavar="RUN", type=Path, help="another one")
    add_plot_argument(parser, "compare.png")
    parser.add_argument("--json", metavar="FILE", help="figures as JSON; - is standard output")


def run(args: argparse.Namespace) -> int:
    """Compare two runs and draw both.

    Parameters
    ----------
    args
        The parsed arguments.

    Raises
    ------
    usmbench.errors.InputError
        A run cannot be read, they have no setting in common, or a file cannot be written.
    """
    from usmbench.report.comparison_plot import write_comparison_plot

    check_outputs({"--plot": args.plot, "--json": args.json}, [args.first, args.second])
    plot_format(args.plot)
    first, second = read_run(args.first), read_run(args.second)
    comparison = compare_pairs(_pairs(first), _pairs(second))
    keys = list(differing_keys(first.meta, second.meta))
    write_comparison_plot(args.plot, comparison, (first.name, second.name))
    warnings = changed_since_closed([first, second])
    warn(warnings)
    figures = _figures(comparison)
    if args.json:
        differing = [key for key, _, _ in keys]
        write_json(args.json, figures | {"differing_keys": differing, "warnings": warnings})
    if args.json != "-":
        for name, value in [
            *_lines(figures, comparison),
            *_key_lines(keys),
            ("plot", str(args.plot)),
        ]:
            print(f"{name:26} {printable(value)}")
    return 0


def _pairs(record: Record) -> Pairs:
    if record.pairs is None:
        raise InputError("no dwell of this run settled: nothing can be compared", file=record.name)
    return record.pairs


def _figures(comparison: Comparison) -> dict[str, Any]:
    difference = comparison.difference_rad_s
    return {
        "n": len(difference),
        "mean_difference_rad_s": float(difference.mean()),
        "rms_difference_rad_s": float(np.sqrt(np.mean(difference**2))),
        "largest_difference_rad_s": float(difference[np.argmax(np.abs(difference))]),
        "expected_rms_rad_s": float(np.sqrt(np.mean(comparison.std_rad_s**2))),
    }


def _lines(figures: dict[str, Any], comparison: Comparison) -> list[tuple[str, str]]:
    """Say how far the runs are apart."""
    at = int(np.argmax(np.abs(comparison.difference_rad_s)))
    where = f"φ = {comparison.phase_deg[at]:g}°"
    where += ", rising" if comparison.direction[at] > 0 else ", falling"
    if np.isfinite(comparison.frequency_hz[at]):
        where += f", {comparison.frequency_hz[at] / 1e3:g} kHz"
    expected = f"{figures['expected_rms_rad_s']:.2g} from the scatter within dwells alone"
    return [
        ("settings in both", str(figures["n"])),
        ("second less first, mean", f"{figures['mean_difference_rad_s']:+.4g} rad/s"),
        ("second less first, rms", f"{figures['rms_difference_rad_s']:.4g} rad/s ({expected})"),
        (
            "second less first, largest",
            f"{figures['largest_difference_rad_s']:+.4g} rad/s, {where}",
        ),
    ]


def _key_lines(keys: Sequence[tuple[str, Any, Any]]) -> list[tuple[str, str]]:
    """Say where the two run.yaml differ."""
    shown = keys[:_KEYS_SHOWN]
    lines = [
        ("they differ in", f"{key}: {_shown(one)} | {_shown(other)}") for key, one, other in shown
    ]
    if len(keys) > _KEYS_SHOWN:
        lines.append(("", f"… and {len(keys) - _KEYS_SHOWN} more keys"))
    return lines


def _shown(value: object) -> str:
    # A plan that only one of them has is told by its name.
    text = str(value.get("name", f"{len(value)} keys") if isinstance(value, dict) else value)
    return text if len(text) <= _VALUE_WIDTH else text[: _VALUE_WIDTH - 1] + "…"
