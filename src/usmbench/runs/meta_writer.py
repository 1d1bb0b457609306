"""run.yaml while a run is measured: begun, taken up again, closed."""

from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

import yaml

from usmbench import __version__
from usmbench.errors import InputError
from usmbench.runs.columns import FORMAT, RUN_FILE
from usmbench.runs.files import disk_error, new_file, replace_file
from usmbench.runs.meta import iso, new_id, now_iso, read_meta, sha256_of
from usmbench.runs.stop_request import forget_stop_request

# Given back before run.yaml is closed, so that a full disk can still be told about.
_RESERVE_FILE = ".reserve"
_RESERVE_BYTES = 65536


def new_meta(meta: Mapping[str, Any]) -> dict[str, Any]:
    """Return what run.yaml says of a run that begins now.

    Parameters
    ----------
    meta
        Motor, encoder, plan, bench. The format, an id, the start and the software's version are
        added.
    """
    started = datetime.now().astimezone()
    head = {
        "format": FORMAT,
        "id": new_id(started),
        "started": iso(started),
        "software": f"usmbench {__version__}",
    }
    return head | dict(meta)


def resumed_meta(folder: Path) -> dict[str, Any]:
    """Return what run.yaml says of a run that is taken up again now.

    Parameters
    ----------
    folder
        The run folder.

    Raises
    ------
    usmbench.errors.InputError
        No such run, or one that is complete.
    """
    meta = read_meta(folder)
    if meta.get("exit") == "completed":
        raise InputError("the run is complete, there is nothing to resume", file=folder)
    for key in ("exit", "stopped", "sha256"):
        meta.pop(key, None)
    before = meta.get("resumed")
    meta["resumed"] = [*(before if isinstance(before, list) else []), now_iso()]
    return meta


def begin_meta(folder: Path, meta: Mapping[str, Any]) -> None:
    """Write run.yaml of a run that goes on.

    Parameters
    ----------
    folder
        The run folder.
    meta
        What it says.

    Raises
    ------
    OSError
        It cannot be written.
    """
    replace_file(folder / RUN_FILE, _text(meta))
    with new_file(folder / _RESERVE_FILE) as file:
        file.write(bytes(_RESERVE_BYTES))


def close_meta(
    folder: Path,
    meta: Mapping[str, Any],
    outcome: str,
    names: Sequence[str],
    extra: Mapping[str, Any],
) -> None:
    """Say in run.yaml how a run ended.

    Parameters
    ----------
    folder
        The run folder.
    meta
        What it said so far.
    outcome
        "completed", "interrupted" or "failed: reason".
    names
        The run's data files, for their check sums.
    extra
        Further keys.

    Raises
    ------
    usmbench.errors.BenchError
        It cannot be written.
    """
    path = folder / RUN_FILE
    try:
        (folder / _RESERVE_FILE).unlink(missing_ok=True)
        forget_stop_request(folder)
        stopped = {"stopped": now_iso(), "exit": outcome, **extra}
        sums = {"sha256": {name: sha256_of(folder / name) for name in names}}
        replace_file(path, _text({**meta, **stopped, **sums}))
    except OSError as error:
        raise disk_error(path, error) from error


def _text(meta: Mapping[str, Any]) -> bytes:
    return yaml.safe_dump(dict(meta), sort_keys=False, allow_unicode=True).encode()
