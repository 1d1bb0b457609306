"""``usmbench replay``: a run's commands through a model, or through a bench again."""

import argparse
from pathlib import Path

import numpy as np

from usmbench.cli.json_output import write_json
from usmbench.errors import InputError
from usmbench.model.model_file import read_model
from usmbench.model.replay import Replay, replay_record
from usmbench.output import warn
from usmbench.report.plot_format import plot_format
from usmbench.runs.output_paths import check_outputs
from usmbench.runs.reader import read_run


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments.

    Parameters
    ----------
    parser
        The subcommand's parser.
    """
    parser.add_argument("recorded", metavar="RUN", type=Path, help="run folder or CSV")
    through = parser.add_mutually_exclusive_group(required=True)
    through.add_argument("--model", type=Path, metavar="MODEL.yaml", help="run the model free")
    through.add_argument("--bench", metavar="BENCH.yaml", help="drive the commands again")
    parser.add_argument("--out", type=Path, metavar="DIR", help="with --bench: the new run folder")
    parser.add_argument("--json", metavar="FILE", help="figures as JSON; - is standard output")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="with --model: a plot (.png, …)")


def run(args: argparse.Namespace) -> int:
    """Replay a run.

    Parameters
    ----------
    args
        The parsed arguments.

    Raises
    ------
    InputError
        The run, the model or an output file will not do.
    """
    if args.bench is not None:
        if args.json is not None or args.plot is not None:
            raise InputError("--json and --plot are for --model; replay the new run through one")
        from usmbench.cli.replay_on_bench import replay_on_bench

        return replay_on_bench(args)
    if args.out is not None:
        raise InputError("--out is for --bench; use --plot or --json with --model")
    check_outputs({"--json": args.json, "--plot": args.plot}, [args.recorded, args.model])
    if args.plot is not None:
        plot_format(args.plot)
    record, model = read_run(args.recorded), read_model(args.model)
    replay = replay_record(record, model)
    warn(replay.warnings)
    if args.plot is not None:
        from usmbench.report.replay_plot import write_replay_plot

        write_replay_plot(args.plot, record, replay)
    if args.json:
        write_json(args.json, replay.to_json())
    if args.json != "-":
        print(_lines(replay))
    return 0


def _lines(replay: Replay) -> str:
    """Say how the model did."""
    fit = "undefined (the speed is constant)"
    if replay.fit_percent is not None:
        fit = f"{replay.fit_percent:.2f} %"
    used = int(np.count_nonzero(replay.simulation.inside))
    return (
        f"rows       {used} of {replay.simulation.inside.size}\n"
        f"RMSE       {replay.rmse_rad_s:.4g} rad/s, free-running\n"
        f"fit        {fit}"
    )
