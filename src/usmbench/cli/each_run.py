"""Diagnose many runs, each on its own, wherever they are worked on."""

from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import replace
from pathlib import Path
from typing import Any

from usmbench import __version__
from usmbench.cli.deciding_runs import judge
from usmbench.cli.text_table import text_table
from usmbench.errors import InputError
from usmbench.model.hammerstein import HammersteinModel
from usmbench.report.plain_text import printable
from usmbench.runs.reader import read_run

_SILENT_S = 1800.0

Entry = dict[str, Any]


def diagnose_each(
    runs: Sequence[Path], model: HammersteinModel, executor: Executor
) -> Iterator[tuple[int, Entry]]:
    """Diagnose every run on its own, and yield each as it is done.

    Parameters
    ----------
    runs
        Run folders or CSV files, which the executor's workers find under the same path.
    model
        The model.
    executor
        What does the work.

    Yields
    ------
    tuple
        The run's place in `runs`, and what ``--json`` says of it: ``run`` and the diagnosis, or
        ``run`` and ``error``, one line. Where nothing is done for half an hour, the rest fails.
    """
    places: dict[Future[Entry], int] = {
        executor.submit(_diagnosed, run.absolute(), str(run), model, __version__): place
        for place, run in enumerate(runs)
    }
    waiting = set(places)
    while waiting:
        done, waiting = wait(waiting, _SILENT_S, FIRST_COMPLETED)
        if not done:
            done, waiting = waiting, set()
        for future in done:
            place = places[future]
            yield place, {"run": str(runs[place]), **_outcome(future)}


def _diagnosed(run: Path, name: str, model: HammersteinModel, version: str) -> Entry:
    """Diagnose one run, in a worker; a run that will not do is an outcome like any other."""
    if version != __version__:
        return {"error": f"the worker has usmbench {__version__}; install {version} there"}
    try:
        record = replace(read_run(run), name=name)
        return judge([record], model).diagnosis.to_json()
    except InputError as error:
        # What was given, as in the table, not where a worker found it.
        return {"error": printable(str(error).replace(str(run), name))}


def _outcome(future: Future[Entry]) -> Entry:
    """Return what a worker said, or why it said nothing."""
    if future.cancel() or not future.done():
        return {"error": f"its worker was lost, or nothing was done for {_SILENT_S:g} s"}
    error = future.exception()
    if error is None:
        return future.result()
    return {"error": printable(f"its worker failed ({type(error).__name__}: {error})")}


def each_warnings(entries: Iterable[Entry]) -> Iterator[str]:
    """Yield the warnings of all runs, each with its run.

    Parameters
    ----------
    entries
        What `diagnose_each` said of each run.
    """
    for entry in entries:
        for warning in entry.get("warnings", ()):
            run = entry["run"]
            yield warning if warning.startswith(f"{run}: ") else f"{run}: {warning}"


def each_table(entries: Sequence[Entry]) -> str:
    """Return one line a run: verdict, gain, causes with their alternatives; or what was wrong.

    Parameters
    ----------
    entries
        What `diagnose_each` said of each run.
    """
    return text_table(("run", "verdict", "gain", "cause"), [_cells(entry) for entry in entries])


def _cells(entry: Entry) -> tuple[str, str, str, str]:
    """Return the cells of one run."""
    if "error" in entry:
        return entry["run"], "not judged", "", entry["error"]
    causes = [" or ".join([c["name"], *c["alternatives"]]) for c in entry["causes"]]
    gain = f"{entry['gain']:.3f}" if causes else ""
    return entry["run"], entry["verdict"], gain, ", ".join(causes)
