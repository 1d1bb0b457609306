"""Where an interrupted run stopped, from the ends of its files."""

from dataclasses import dataclass
from pathlib import Path

from usmbench.errors import InputError
from usmbench.runs.columns import PAIRS_FILE, WINDOWS_FILE

# Far more than the longest row.
_TAIL_BYTES = 4096


@dataclass(frozen=True, slots=True)
class StopPoint:
    """Where an interrupted run stopped.

    Parameters
    ----------
    last_dwell
        Number of the last dwell that has its pair, -1 where there is none.
    t_s
        End of the last window, 0 where there is none.
    sweep
        Number of the pass of the last window, -1 where there is none.
    angle_rad
        Shaft angle at the end of the last window.
    """

    last_dwell: int = -1
    t_s: float = 0.0
    sweep: int = -1
    angle_rad: float = 0.0


def columns_of(path: Path, allowed: tuple[tuple[str, ...], ...]) -> tuple[str, ...]:
    """Return the column names of a file that is to be continued.

    Parameters
    ----------
    path
        windows.csv or pairs.csv; one that is missing or empty has the first allowed columns.
    allowed
        The sets of columns that this program writes.

    Raises
    ------
    usmbench.errors.InputError
        The file cannot be read or has other columns.
    """
    try:
        with path.open("rb") as file:
            head = file.readline(_TAIL_BYTES)
    except FileNotFoundError:
        head = b""
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", file=path) from error
    if not head.endswith(b"\n"):
        return allowed[0]
    names = tuple(head.decode(errors="replace").strip().split(","))
    if names not in allowed:
        raise InputError(
            "the columns are not those that a sweep writes, rows cannot be appended; "
            "start a new run instead of resuming",
            file=path,
            line=1,
        )
    return names


def stop_point(folder: Path) -> StopPoint:
    """Return where the run in a folder stopped.

    Parameters
    ----------
    folder
        The run folder, its files ending in whole rows.

    Raises
    ------
    usmbench.errors.InputError
        A last row that is not this program's.
    """
    window = _last_row(folder / WINDOWS_FILE)
    pair = _last_row(folder / PAIRS_FILE)
    return StopPoint(
        last_dwell=int(pair.get("dwell", -1)),
        t_s=window.get("t_s", 0.0),
        sweep=int(window.get("sweep", -1)),
        angle_rad=window.get("angle_rad", 0.0),
    )


def _last_row(path: Path) -> dict[str, float]:
    """Return the last row by column name, empty where there is none."""
    try:
        with path.open("rb") as file:
            names = file.readline(_TAIL_BYTES).decode().strip().split(",")
            start = file.tell()
            file.seek(max(start, file.seek(0, 2) - _TAIL_BYTES))
            rows = file.read().decode().splitlines()
        if not rows:
            return {}
        return dict(zip(names, map(float, rows[-1].split(",")), strict=True))
    except (OSError, ValueError) as error:
        raise InputError(
            "the last row is not one that a sweep wrote; remove it and resume again", file=path
        ) from error
