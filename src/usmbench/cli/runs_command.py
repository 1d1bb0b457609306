"""``usmbench runs``: what was measured, found by what run.yaml says, and held to its check sums."""

import argparse
from collections.abc import Iterable, Sequence
from pathlib import Path, PurePosixPath
from typing import Any

from usmbench.cli.json_output import write_json
from usmbench.cli.runs_folder import RUNS_FOLDER
from usmbench.cli.text_table import text_table
from usmbench.errors import InputError
from usmbench.output import warn
from usmbench.runs.catalogue import RunSummary, changed_data, find_runs
from usmbench.runs.condition import parse_condition
from usmbench.runs.output_paths import check_outputs

_HEADS = ("run", "started", "plan", "points", "exit", "fit")
_EXIT_WIDTH = 40


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments.

    Parameters
    ----------
    parser
        The subcommand's parser.
    """
    parser.add_argument("folder", metavar="FOLDER", type=Path, nargs="?", default=RUNS_FOLDER)
    parser.add_argument(
        "--find",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help="only runs whose run.yaml says so, such as plan.name=phase-sweep or exit=failed*",
    )
    parser.add_argument("--check", action="store_true", help="hold the data to its check sums")
    parser.add_argument("--json", metavar="FILE", help="the list as JSON; - is standard output")


def run(args: argparse.Namespace) -> int:
    """List the runs of a folder.

    Parameters
    ----------
    args
        The parsed arguments.

    Raises
    ------
    usmbench.errors.InputError
        There is no such folder, a condition is none, the list cannot be written, or the data of a
        run is not what it was or cannot be checked.
    """
    check_outputs({"--json": args.json})
    found = find_runs(args.folder, [parse_condition(text) for text in args.find])
    data, unchecked = _held_to_sums(found.runs if args.check else ())
    unreadable = [*found.unreadable, *unchecked]
    warn(unreadable)
    fits = model_fits(args.folder, found.runs)
    if args.json:
        rows = [_json(run, fits, data if args.check else None) for run in found.runs]
        write_json(args.json, {"runs": rows})
    if args.json != "-":
        print(text_table(_HEADS, [_line(run, args.folder, fits) for run in found.runs]))
        print(_runs(len(found.runs)))
    changed = [(name, files) for name, files in data.items() if files]
    if changed:
        name, files = changed[0]
        raise InputError(
            f"{' and '.join(files)} changed after the run was closed, in {len(changed)} of "
            f"{_runs(len(found.runs))}; restore the data from a copy",
            file=name,
        )
    if args.check and unreadable:
        folders = "1 folder" if len(unreadable) == 1 else f"{len(unreadable)} folders"
        raise InputError(
            f"{folders} in it could not be checked, see the warnings; mend or move what they name. "
            "The data of the others is unchanged",
            file=args.folder,
        )
    if args.check and args.json != "-":
        closed = sum(run.exit_text != "open" for run in found.runs)
        print(f"data unchanged since it was written: {_runs(closed)} of {len(found.runs)}")
    return 0


def _runs(number: int) -> str:
    return "1 run" if number == 1 else f"{number} runs"


def model_fits(folder: Path, runs: Sequence[RunSummary]) -> dict[Path, float]:
    """Return the free-running RMSE in rad/s of runs that a model was fitted on.

    Parameters
    ----------
    folder
        Folder whose model files are read, beside those of the working folder.
    runs
        The runs.
    """
    models = _models(folder)
    if not models:
        return {}
    places = {run.folder: run.folder.resolve().parts for run in runs}
    return {
        place: rmse_rad_s
        for name, rmse_rad_s in models
        for place, parts in places.items()
        if parts[-len(name) :] == name
    }


def _models(folder: Path) -> list[tuple[tuple[str, ...], float]]:
    """Return the runs that models say they were fitted on, and how well."""
    files = sorted({*folder.glob("*.yaml"), *Path().glob("*.yaml")})
    if not files:
        return []
    from usmbench.model.model_file import read_model

    fits = []
    for file in files:
        try:
            model = read_model(file)
        except InputError:
            continue  # a plan, a bench, or a run folder's own run.yaml
        rmse_rad_s = model.residual.get("rmse_free_run_rad_s")
        if isinstance(rmse_rad_s, float):
            fits += [(_tail(run.get("name", "")), rmse_rad_s) for run in model.fitted_on]
    return [(name, rmse_rad_s) for name, rmse_rad_s in fits if name]


def _tail(name: object) -> tuple[str, ...]:
    """Return the parts of a run's path that mean the same wherever it was named from."""
    return tuple(part for part in PurePosixPath(str(name)).parts if part not in ("/", "..", "."))


def _held_to_sums(runs: Iterable[RunSummary]) -> tuple[dict[Path, list[str]], list[str]]:
    """Return the files of each run that are not what they were, and why runs cannot be checked."""
    changed: dict[Path, list[str]] = {}
    unchecked: list[str] = []
    for run in runs:
        try:
            changed[run.folder] = changed_data(run.folder)
        except InputError as error:
            unchecked.append(str(error))
    return changed, unchecked


def points_text(run: RunSummary) -> str:
    """Return the operating points of a run's plan in words.

    Parameters
    ----------
    run
        The run.
    """
    if not run.frequencies_hz:
        return "-"
    kilohertz = _few([frequency_hz / 1e3 for frequency_hz in run.frequencies_hz], "kHz")
    return f"{kilohertz}, {_few(run.torques_nm, 'N·m')}"


def _few(values: Sequence[float], unit: str) -> str:
    if len(values) > 3:
        return f"{len(values)} from {min(values):g} to {max(values):g} {unit}"
    return f"{'/'.join(f'{value:g}' for value in values)} {unit}"


def _line(run: RunSummary, folder: Path, fits: dict[Path, float]) -> tuple[str, ...]:
    name = run.folder.relative_to(folder).as_posix() if run.folder != folder else run.folder.name
    fit = fits.get(run.folder)
    outcome = run.exit_text
    if len(outcome) > _EXIT_WIDTH:
        outcome = outcome[: _EXIT_WIDTH - 1] + "…"
    return (
        name,
        "-" if run.started is None else f"{run.started:%Y-%m-%d %H:%M}",
        run.plan or "-",
        points_text(run),
        outcome,
        "-" if fit is None else f"{fit:.3g} rad/s",
    )


def _json(
    run: RunSummary, fits: dict[Path, float], data: dict[Path, list[str]] | None
) -> dict[str, Any]:
    row: dict[str, Any] = {
        "folder": str(run.folder),
        "id": run.run_id,
        "started": None if run.started is None else run.started.isoformat(),
        "plan": run.plan,
        "frequency_hz": list(run.frequencies_hz),
        "torque_nm": list(run.torques_nm),
        "exit": run.exit_text,
        "rmse_free_run_rad_s": fits.get(run.folder),
    }
    if data is not None:
        row["changed"] = data.get(run.folder)  # null where it cannot be checked
    return row
