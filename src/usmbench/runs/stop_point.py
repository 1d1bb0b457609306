"""Where an interrupted run stopped, from the ends of its files."""

from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from usmbench.errors import InputError
from usmbench.runs.columns import PAIRS_FILE, WINDOWS_FILE

# Far more than the longest head.
_HEAD_BYTES = 4096


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
            head = file.readline(_HEAD_BYTES)
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
        The run folder; nothing in it is changed.

    Raises
    ------
    usmbench.errors.InputError
        A last row that is not this program's, or windows that end before the pairs made from them.
    """
    window = _last_row(folder / WINDOWS_FILE, ("t_s", "sweep", "angle_rad"))
    pair = _last_row(folder / PAIRS_FILE, ("t_s", "dwell"))
    stopped = StopPoint(
        last_dwell=int(pair.get("dwell", -1)),
        t_s=window.get("t_s", 0.0),
        sweep=int(window.get("sweep", -1)),
        angle_rad=window.get("angle_rad", 0.0),
    )
    if pair.get("t_s", 0.0) > stopped.t_s:
        raise InputError(
            f"ends at {stopped.t_s:g} s, {PAIRS_FILE} at {pair['t_s']:g} s: windows are missing; "
            "put the file back from a copy, or remove the pairs that are later than its end, and "
            "resume again",
            file=folder / WINDOWS_FILE,
        )
    return stopped


def _last_row(path: Path, needed: tuple[str, ...]) -> dict[str, float]:
    """Return the last whole row by column name, empty where there is none."""
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", file=path) from error
    head, _, rows = content[: content.rfind(b"\n") + 1].partition(b"\n")
    if not rows:
        return {}
    try:
        values = map(float, rows[:-1].rpartition(b"\n")[2].decode().split(","))
        row = dict(zip(head.decode().strip().split(","), values, strict=True))
        wrong = not all(isfinite(row[name]) for name in needed)
    except (KeyError, ValueError):
        wrong = True
    if wrong:
        raise InputError(
            "the last row is not one that a sweep wrote; remove it and resume again",
            file=path,
            line=rows.count(b"\n") + 1,
        )
    return row
