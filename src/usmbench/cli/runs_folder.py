"""The folder of a run that is to be driven: chosen, free, and named in the end."""

from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import Final, TextIO

from usmbench.errors import InputError
from usmbench.output import print_or_drop
from usmbench.runs.columns import RUN_FILE
from usmbench.runs.writer import EXISTS

RUNS_FOLDER: Final = Path("runs")


def new_run_folder(name: str, folder: Path = RUNS_FOLDER) -> Path:
    """Return the path of a run that begins now; nothing is made.

    Parameters
    ----------
    name
        What the run is of, as a part of a file's name.
    folder
        The folder of the runs.
    """
    return folder / f"{datetime.now():%Y%m%dT%H%M%S}-{name}"


def check_absent(folder: Path) -> None:
    """Refuse a folder that exists, before a bench is opened for it.

    Parameters
    ----------
    folder
        The folder to make.

    Raises
    ------
    usmbench.errors.InputError
        It exists.
    """
    if folder.exists():
        raise InputError(EXISTS, file=folder)


@contextmanager
def named_at_the_end(folder: Path, stream: TextIO | None = None) -> Iterator[None]:
    """Print, however a run ends, where its rows are.

    Parameters
    ----------
    folder
        The run folder; where none was made nothing is printed.
    stream
        Where to; None for standard output.
    """
    try:
        yield
    finally:
        if (folder / RUN_FILE).exists():
            print_or_drop(folder, stream)
