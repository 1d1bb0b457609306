"""run.yaml and the check sums in it."""

import hashlib
import secrets
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from typing import Any

from usmbench.errors import InputError
from usmbench.runs.columns import FORMAT, RUN_FILE
from usmbench.settings.regular_file import refuse_endless
from usmbench.settings.schema import check
from usmbench.settings.yaml_source import MAX_NUMBER, Source, read_source

_TELLS_MOTOR = ("name", "maker", "type", "model", "serial", "serial_number", "id")
MOST_BYTES = 10_000_000
"""Length of a run.yaml at most; users may keep much beside what the run says."""


def iso(moment: datetime) -> str:
    """Return a moment as run.yaml writes it: ISO 8601.

    Parameters
    ----------
    moment
        The moment, with its zone.
    """
    return moment.isoformat(timespec="milliseconds")


def now_iso() -> str:
    """Return what time it is, as run.yaml writes it."""
    return iso(datetime.now().astimezone())


def new_id(moment: datetime) -> str:
    """Return the id of a run, which no other run has.

    Parameters
    ----------
    moment
        When the run began.
    """
    return f"{moment:%Y%m%dT%H%M%S}-{secrets.token_hex(4)}"


def sha256_of(path: Path) -> str:
    """Return a file's SHA-256, in hexadecimal.

    Parameters
    ----------
    path
        The file.
    """
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def read_meta(folder: Path) -> dict[str, Any]:
    """Return what a run folder's run.yaml says.

    Parameters
    ----------
    folder
        The run folder.

    Returns
    -------
    dict
        The keys of run.yaml; any but `format` may be missing.

    Raises
    ------
    usmbench.errors.InputError
        No such file, not YAML, not a format this version reads, or a key that holds what it cannot.
    """
    source = run_source(folder)
    check(source, "run")
    return dict(source.document)


def run_source(folder: Path) -> Source:
    """Return a run folder's run.yaml, of whose keys none but `format` has been looked at.

    Parameters
    ----------
    folder
        The run folder.

    Raises
    ------
    usmbench.errors.InputError
        No such file, not YAML, or not a format this version reads.
    """
    path = folder / RUN_FILE
    mend = "name a run folder or a CSV file"
    source = read_source(path, MOST_BYTES, plain=False, mend=mend)
    if not isinstance(source.document, dict):
        raise InputError(f"has no keys; it must at least say format: {FORMAT}", file=path)
    stated = source.document.get("format")
    if stated != FORMAT:
        message = f"{stated!r}, this version reads {FORMAT}; install the usmbench that wrote it"
        raise source.error(("format",), message)
    return source


def said_window_s(meta: Mapping[str, Any]) -> float | None:
    """Return the duration of a run's windows by run.yaml, None where it does not say.

    Parameters
    ----------
    meta
        What run.yaml says.
    """
    encoder = meta.get("encoder") or {}
    samples, rate_hz = encoder.get("samples_per_average"), encoder.get("sample_rate_hz")
    return None if samples is None or rate_hz is None else float(samples / rate_hz)


def said_motor(meta: Mapping[str, Any]) -> str | None:
    """Return which motor a run is of by run.yaml, None where it does not say.

    Parameters
    ----------
    meta
        What run.yaml says. A mapping tells a motor by its name, its type and its number, or, where
        it has none of these, by all that it says.
    """
    motor = meta.get("motor")
    if isinstance(motor, Mapping):
        known = [motor[key] for key in _TELLS_MOTOR if motor.get(key) is not None]
        motor = " ".join(str(word) for word in known) or ", ".join(
            f"{key} {value}" for key, value in motor.items()
        )
    return None if motor in (None, "") else str(motor)


def said_numbers(value: object) -> tuple[float, ...]:
    """Return the number, or the list of numbers, that a key of the plan holds.

    Parameters
    ----------
    value
        What stands there; what is no number, or one beyond any plan's, is left out.
    """
    values = value if isinstance(value, list) else [value]
    numbers = (number for number in values if isinstance(number, int | float))
    return tuple(float(number) for number in numbers if abs(number) <= MAX_NUMBER)


def changed_files(folder: Path, sums: object) -> list[str]:
    """Hold the data files against check sums.

    Parameters
    ----------
    folder
        The run folder.
    sums
        What run.yaml says under `sha256`; None for a run that was never closed.

    Returns
    -------
    list of str
        Names of the files that are missing or have changed.

    Raises
    ------
    usmbench.errors.InputError
        The sums are none, or of a file that lies outside the folder, has no end or cannot be read.
    """
    if sums is None:
        return []
    if not isinstance(sums, dict):
        message = "sha256 must map file names to sums; mend or remove the entry"
        raise InputError(message, file=folder / RUN_FILE)
    changed = []
    for name, expected in sums.items():
        path = inside(folder, name)
        refuse_endless(path)
        try:
            unchanged = sha256_of(path) == expected
        except FileNotFoundError:
            unchanged = False
        except OSError as error:
            raise InputError(
                f"cannot be read: {error.strerror}; make it readable", file=path
            ) from error
        if not unchanged:
            changed.append(str(name))
    return changed


def inside(folder: Path, name: object) -> Path:
    """Return the path of a data file that run.yaml names.

    Parameters
    ----------
    folder
        The run folder.
    name
        The name as run.yaml has it.

    Raises
    ------
    usmbench.errors.InputError
        The file would not lie in the folder.
    """
    text = str(name)
    # Not resolved: that asks the system for every folder on the way, of every file of every run.
    if text not in ("", "..") and "\0" not in text and Path(text).name == text:
        path = folder / text
        if not path.is_symlink():
            return path
    raise InputError(
        f"sha256 names {name!r}, which is not a file of this folder; remove the entry",
        file=folder / RUN_FILE,
    )
