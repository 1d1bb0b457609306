"""``usmbench show``: one run in some lines and a plot."""

import argparse
from pathlib import Path

import numpy as np

from usmbench.cli.plot_argument import add_plot_argument
from usmbench.output import warn
from usmbench.report.plain_text import printable
from usmbench.report.plot_format import plot_format
from usmbench.runs.check_record import changed_since_closed
from usmbench.runs.output_paths import check_outputs
from usmbench.runs.reader import read_run
from usmbench.runs.record import Record

_META = ("started", "motor", "exit", "software")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments.

    Parameters
    ----------
    parser
        The subcommand's parser.
    """
    parser.add_argument("recorded", metavar="RUN", type=Path, help="run folder or CSV")
    add_plot_argument(parser, "show.png")
    parser.add_argument(
        "--model", type=Path, metavar="MODEL.yaml", help="draw its curve beside the pairs"
    )


def run(args: argparse.Namespace) -> int:
    """Describe and draw a run.

    Parameters
    ----------
    args
        The parsed arguments.

    Raises
    ------
    usmbench.errors.InputError
        The run or the model cannot be read, or the plot cannot be written.
    """
    from usmbench.report.run_plot import write_run_plot

    check_outputs({"--plot": args.plot}, [args.recorded, args.model])
    plot_format(args.plot)
    record = read_run(args.recorded)
    model = None
    if args.model is not None:
        from usmbench.model.model_file import read_model

        model = read_model(args.model)
    write_run_plot(args.plot, record, model)
    warn(changed_since_closed([record]))
    for name, value in _lines(record, args.plot):
        print(f"{name:11} {printable(value)}")
    return 0


def _lines(record: Record, plot: Path) -> list[tuple[str, str]]:
    """Return what there is to say, name by name."""
    meta, speed = record.meta, record.speed_rad_s
    plan = meta.get("plan")
    lines = [("run", record.name)]
    said = {**meta, "motor": record.motor}
    lines += [(key, str(said[key])) for key in _META if said.get(key) is not None]
    if isinstance(plan, dict) and plan.get("name") is not None:
        lines.append(("plan", str(plan["name"])))
    window_s = record.usual_window_s
    in_all_s = record.window_s.sum()
    lines.append(("windows", f"{len(speed)} of {1e3 * window_s:.4g} ms, {in_all_s:.2f} s in all"))
    lines.append(("speed", f"{speed.min():.4g} to {speed.max():.4g} rad/s"))
    if record.temperature_c is not None and np.isfinite(record.temperature_c).any():
        low, high = np.nanmin(record.temperature_c), np.nanmax(record.temperature_c)
        lines.append(("temperature", f"{low:.1f} to {high:.1f} °C"))
    if record.pairs is not None:
        scatter = float(np.median(record.pairs.speed_std_rad_s))
        pairs = f"{len(record.pairs.t_s)}, scatter within a dwell {scatter:.3g} rad/s (median)"
        lines.append(("pairs", pairs))
    return [*lines, ("plot", str(plot))]
