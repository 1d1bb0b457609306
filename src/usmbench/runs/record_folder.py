"""A run folder at one go: for what was measured by another program."""

import csv
import io
import shutil
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.runs.columns import DRIVE_COLUMN, PAIR_COLUMNS, PAIRS_FILE, RUN_FILE, WINDOWS_FILE
from usmbench.runs.dwells import derive_pairs
from usmbench.runs.files import replace_file
from usmbench.runs.meta import sha256_of
from usmbench.runs.record import Pairs, Record

_NOT_COLUMNS = ("name", "pairs", "meta", "extra", "changed")


def write_record(folder: Path, record: Record, meta: Mapping[str, Any]) -> None:
    """Write a closed run folder; pairs are derived where the run has none.

    Parameters
    ----------
    folder
        The folder to make; its parents are made too.
    record
        The run.
    meta
        What run.yaml says: format, id, started and exit at least. The check sums are added.

    Raises
    ------
    usmbench.errors.InputError
        The folder exists, or cannot be made or written.
    """
    columns = {
        part.name: getattr(record, part.name)
        for part in fields(Record)
        if part.name not in _NOT_COLUMNS
    }
    written = {name: column for name, column in columns.items() if column is not None}
    texts = {WINDOWS_FILE: _table(written | record.extra)}
    of_dwells = columns | {DRIVE_COLUMN: record.driven}
    pairs = record.pairs or derive_pairs(
        record.t_s, record.phase_deg, record.speed_rad_s, of_dwells
    )
    # Pairs at an operating point that nobody knows are left to the reader to derive.
    if pairs is not None and _complete(pairs):
        texts[PAIRS_FILE] = _table({name: getattr(pairs, name) for name in PAIR_COLUMNS})
    write_folder(folder, texts, meta)


def write_folder(folder: Path, texts: Mapping[str, str], meta: Mapping[str, Any]) -> None:
    """Write a run folder, whole or not at all.

    Parameters
    ----------
    folder
        The folder to make; its parents are made too.
    texts
        The data files, by their names.
    meta
        What run.yaml says. The check sums are added where it says how the run ended.

    Raises
    ------
    usmbench.errors.InputError
        The folder exists, or cannot be made or written.
    """
    try:
        folder.mkdir(parents=True)
    except FileExistsError:
        raise InputError("exists already; name another folder", file=folder) from None
    except OSError as error:
        message = f"cannot be made: {error.strerror}; name another folder"
        raise InputError(message, file=folder) from error
    try:
        _fill(folder, texts, meta)
    except OSError as error:
        shutil.rmtree(folder, ignore_errors=True)
        message = f"cannot be written: {error.strerror}; free some space or name another folder"
        raise InputError(message, file=folder) from error


def _fill(folder: Path, texts: Mapping[str, str], meta: Mapping[str, Any]) -> None:
    for name, text in texts.items():
        replace_file(folder / name, text.encode())
    said = dict(meta)
    if "exit" in said:
        said["sha256"] = {name: sha256_of(folder / name) for name in texts}
    text = yaml.safe_dump(said, sort_keys=False, allow_unicode=True)
    replace_file(folder / RUN_FILE, text.encode())


def _complete(pairs: Pairs) -> bool:
    return all(bool(np.isfinite(getattr(pairs, name)).all()) for name in PAIR_COLUMNS)


def _table(columns: Mapping[str, NDArray[Any]]) -> str:
    """Return columns as CSV, numbers to twelve digits as the sweep writes them."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(_cells(column) for column in columns.values()), strict=True))
    return text.getvalue()


def _cells(column: NDArray[Any]) -> list[str]:
    if column.dtype.kind == "f":
        return [f"{value:.12g}" for value in column.tolist()]
    return [str(value) for value in column.tolist()]
