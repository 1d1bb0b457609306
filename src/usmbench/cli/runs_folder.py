"""Where runs go that nobody named a folder for."""

from datetime import datetime
from pathlib import Path
from typing import Final

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
