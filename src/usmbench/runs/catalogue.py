"""What was measured: the runs of a folder, found by what their run.yaml says."""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from usmbench.errors import InputError
from usmbench.runs.columns import RUN_FILE
from usmbench.runs.condition import Condition
from usmbench.runs.meta import changed_files, said_numbers
from usmbench.runs.meta_blocks import MetaBlocks

_BEFORE_ALL: Final = datetime.min.replace(tzinfo=UTC)


@dataclass(frozen=True, slots=True)
class RunSummary:
    """One line of the list of runs.

    Parameters
    ----------
    folder
        The run folder.
    run_id
        The run's id, None where run.yaml has none.
    started
        When the run started, None where run.yaml does not say.
    plan
        Name of the plan, None where there is none.
    frequencies_hz, torques_nm
        Operating points of the plan.
    exit_text
        "completed", "interrupted", "failed: reason"; "open" where the run was never closed.
    """

    folder: Path
    run_id: str | None
    started: datetime | None
    plan: str | None
    frequencies_hz: tuple[float, ...]
    torques_nm: tuple[float, ...]
    exit_text: str


@dataclass(frozen=True, slots=True)
class Catalogue:
    """The runs of a folder.

    Parameters
    ----------
    runs
        Those that fulfil every condition, the oldest first.
    unreadable
        Folders that cannot be searched, or whose run.yaml cannot be read, one message each.
    """

    runs: tuple[RunSummary, ...]
    unreadable: tuple[str, ...]


def find_runs(folder: Path, conditions: Sequence[Condition] = ()) -> Catalogue:
    """List the runs in a folder and in the folders below it.

    Parameters
    ----------
    folder
        Where to look; a run folder is a list of one.
    conditions
        What the runs must say.

    Raises
    ------
    usmbench.errors.InputError
        There is no such folder, or it cannot be read.
    """
    runs: list[RunSummary] = []
    unreadable: list[str] = []
    for run_folder in _run_folders(folder, unreadable):
        try:
            meta = MetaBlocks(run_folder)
            if all(condition.holds(meta) for condition in conditions):
                runs.append(_summary(run_folder, meta))
        except InputError as error:
            unreadable.append(str(error))
    return Catalogue(tuple(sorted(runs, key=_age)), tuple(unreadable))


def changed_data(folder: Path) -> list[str]:
    """Hold a run's data files against the check sums in its run.yaml.

    Parameters
    ----------
    folder
        The run folder.

    Returns
    -------
    list of str
        Names of the files that are missing or have changed.

    Raises
    ------
    usmbench.errors.InputError
        A file of the run cannot be read, or run.yaml names one outside the folder.
    """
    return changed_files(folder, MetaBlocks(folder).get("sha256"))


def _run_folders(folder: Path, unreadable: list[str]) -> Iterator[Path]:
    """Yield the run folders in a folder and below it, links left alone; tell what is closed."""
    if not folder.is_dir():
        raise InputError("is no folder; name the one that holds the runs", file=folder)
    waiting = [str(folder)]
    while waiting:
        path = waiting.pop()
        # A run folder is not searched: of a long list, that is most of the work saved.
        if os.path.exists(f"{path}/{RUN_FILE}"):  # noqa: PTH110 - Path takes ten times as long
            yield Path(path)
            continue
        try:
            with os.scandir(path) as entries:
                waiting += [e.path for e in entries if e.is_dir(follow_symlinks=False)]
        except OSError as error:
            closed = InputError(
                f"cannot be searched: {error.strerror}; make it readable", file=path
            )
            if Path(path) == folder:
                raise closed from None
            unreadable.append(str(closed))


def _summary(folder: Path, meta: MetaBlocks) -> RunSummary:
    plan, outcome, run_id = meta.get("plan"), meta.get("exit"), meta.get("id")
    plan = plan if isinstance(plan, dict) else {}
    name = plan.get("name")
    return RunSummary(
        folder=folder,
        run_id=None if run_id is None else str(run_id),
        started=_instant(meta.get("started")),
        plan=None if name is None else str(name),
        frequencies_hz=said_numbers(plan.get("frequency_hz")),
        torques_nm=said_numbers(plan.get("torque_nm", 0.0 if plan else None)),
        exit_text="open" if outcome is None else str(outcome),
    )


def _instant(value: object) -> datetime | None:
    """Return an instant with its zone; YAML may have made a date of it."""
    try:
        when = value if isinstance(value, datetime) else datetime.fromisoformat(str(value))
        # Of the calendar's first and last day there is none in another zone.
        return when if when.tzinfo is not None else when.astimezone()
    except (ValueError, OverflowError):
        return None


def _age(run: RunSummary) -> tuple[datetime, str]:
    return run.started or _BEFORE_ALL, str(run.folder)
