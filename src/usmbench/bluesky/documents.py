"""A run folder as a stream of event-model documents, and such a stream as a run folder.

Streams: ``primary`` holds the pairs, one event a dwell as a scan would emit them; ``windows`` every
row of windows.csv, in event pages. What run.yaml says travels in the start document.
"""

from collections.abc import Iterable, Iterator, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any, Final, Literal, cast

import numpy as np
import yaml
from event_model import (
    ComposeDescriptorBundle,
    DataKey,
    DocumentNames,
    EventPage,
    compose_run,
    schema_validators,
    unpack_event_page,
)
from jsonschema import ValidationError

from usmbench.bluesky.run_rows import PRIMARY, WINDOWS, RunRows
from usmbench.bluesky.signals import data_key
from usmbench.errors import InputError
from usmbench.runs.columns import FORMAT, PAIRS_FILE, WINDOWS_FILE
from usmbench.runs.csv_table import Table, Values, read_table
from usmbench.runs.meta import iso, read_meta, said_motor
from usmbench.runs.record_folder import write_folder

Document = tuple[str, dict[str, Any]]

META_KEY: Final = "usmbench"
RUN_KEY: Final = "run_yaml"
PAGE_ROWS: Final = 1000
_FILES: Final = {PRIMARY: PAIRS_FILE, WINDOWS: WINDOWS_FILE}
# How a run ended, by event-model's names and back.
_EXITS: Final[dict[str, Literal["success", "abort"]]] = {
    "completed": "success",
    "interrupted": "abort",
}
_UNITS: Final = {
    "rad_s": "rad/s",
    "deg": "deg",
    "hz": "Hz",
    "nm": "N·m",
    "rad": "rad",
    "c": "°C",
    "s": "s",
}


def run_documents(folder: Path) -> Iterator[Document]:
    """Yield a run folder as event-model documents.

    Parameters
    ----------
    folder
        The run folder.

    Yields
    ------
    tuple
        Name and content of each document: start, descriptors, event pages, stop.

    Raises
    ------
    usmbench.errors.InputError
        The run cannot be read.
    """
    meta = read_meta(folder)
    started_s = _epoch_s(meta.get("started"))
    plan = meta.get("plan")
    named = plan.get("name") if isinstance(plan, dict) else None
    # As text: its keys may hold characters that a start document's may not.
    said = {"id": str(meta.get("id")), "motor": str(said_motor(meta)), RUN_KEY: _yaml(meta)}
    head = {"plan_name": str(named or "usmbench"), META_KEY: said}
    run = compose_run(time=started_s, metadata=head)
    yield "start", dict(run.start_doc)
    last_s = started_s
    for stream, name in _FILES.items():
        path = folder / name
        if not path.exists() and stream == PRIMARY:
            continue
        table = read_table(path, needed=(), numbers=(), whole_rows=True, may_be_empty=True)
        keys = {column: _key(name, column, values) for column, values in table.columns.items()}
        bundle = run.compose_descriptor(name=stream, data_keys=keys, time=started_s)
        yield "descriptor", dict(bundle.descriptor_doc)
        for page in _pages(table, started_s, bundle):
            last_s = max(last_s, page["time"][-1])
            yield "event_page", page
    outcome = str(meta.get("exit", "interrupted"))
    status: Literal["success", "abort", "fail"] = _EXITS.get(outcome, "fail")
    yield "stop", dict(run.compose_stop(exit_status=status, reason=outcome, time=last_s))


def _pages(
    table: Table, started_s: float, bundle: ComposeDescriptorBundle
) -> Iterator[dict[str, Any]]:
    """Yield a table as event pages."""
    n_rows = len(next(iter(table.columns.values())))
    t_s = table.columns.get("t_s", np.zeros(n_rows))
    for first in range(0, n_rows, PAGE_ROWS):
        rows = slice(first, min(first + PAGE_ROWS, n_rows))
        times_s = (started_s + np.asarray(t_s[rows], dtype=np.float64)).tolist()
        data = {column: values[rows].tolist() for column, values in table.columns.items()}
        page = bundle.compose_event_page(
            data=data,
            timestamps=dict.fromkeys(data, times_s),
            seq_num=list(range(first + 1, rows.stop + 1)),
            time=times_s,
        )
        yield dict(page)


def _key(file: str, column: str, values: Values) -> DataKey:
    if values.dtype.kind == "U":
        return {"source": f"usmbench:{file}", "dtype": "string", "shape": []}
    unit = next((unit for end, unit in _UNITS.items() if column.endswith(f"_{end}")), None)
    return data_key(file, unit)


def documents_run(documents: Iterable[tuple[str, Mapping[str, Any]]], folder: Path) -> None:
    """Write a run folder from event-model documents, of `run_documents` or of a scan.

    Parameters
    ----------
    documents
        Name and content of each document of one run. A scan over the devices of
        `usmbench.bluesky` has the pairs in its stream ``primary``; where it recorded no stream
        ``windows``, each pair stands for one window as well.
    folder
        The folder to make.

    Raises
    ------
    usmbench.errors.InputError
        A document is not event-model's, there is no measurement in them, or the folder exists, or
        cannot be made or written.
    """
    rows = RunRows()
    start: Mapping[str, Any] = {}
    stop: Mapping[str, Any] = {}
    for name, document in documents:
        _check(name, document)
        if name == "start":
            if start:
                raise InputError("the documents are of several runs; give those of one")
            start = document
        elif name == "descriptor":
            rows.declare(document)
        elif name == "event":
            rows.add(document)
        elif name == "event_page":
            for event in unpack_event_page(cast(EventPage, document)):
                rows.add(event)
        elif name == "stop":
            stop = document
    if not start:
        raise InputError("the documents have no start; give those of one whole run")
    write_folder(folder, rows.texts(float(start["time"])), _meta(start, stop))


def _check(name: str, document: Mapping[str, Any]) -> None:
    """Refuse what event-model's schemas refuse."""
    try:
        schema_validators[DocumentNames[name]].validate(document)
    except KeyError:
        raise InputError(f"{name} is no kind of event-model document") from None
    except ValidationError as error:
        message = f"a {name} document is not event-model's: {error.message}"
        raise InputError(message) from error


def _meta(start: Mapping[str, Any], stop: Mapping[str, Any]) -> dict[str, Any]:
    """Return run.yaml of a run, its check sums aside."""
    kept = start.get(META_KEY)
    if isinstance(kept, dict) and RUN_KEY in kept:
        return _kept_meta(str(kept[RUN_KEY]))
    meta: dict[str, Any] = {
        "format": FORMAT,
        "id": str(start["uid"]),
        "started": iso(_moment(float(start["time"]))),
        "software": f"bluesky plan {start.get('plan_name', 'unknown')}",
    }
    if stop:
        names: dict[str, str] = {status: outcome for outcome, status in _EXITS.items()}
        reason = f"failed: {stop.get('reason') or 'unknown'}"
        meta["stopped"] = iso(_moment(float(stop["time"])))
        meta["exit"] = names.get(str(stop["exit_status"]), reason)
    return meta


def _kept_meta(text: str) -> dict[str, Any]:
    """Return what run.yaml said before it became a document."""
    try:
        meta = yaml.safe_load(text)
    except yaml.YAMLError:
        meta = None
    if not isinstance(meta, dict) or meta.get("format") != FORMAT:
        raise InputError(f"the start document's {META_KEY}.{RUN_KEY} is no run.yaml; remove it")
    return {key: value for key, value in meta.items() if key != "sha256"}


def _yaml(meta: Mapping[str, Any]) -> str:
    return yaml.safe_dump(dict(meta), sort_keys=False, allow_unicode=True)


def _epoch_s(started: object) -> float:
    try:
        return datetime.fromisoformat(str(started)).timestamp()
    except ValueError:
        return 0.0


def _moment(time_s: float) -> datetime:
    return datetime.fromtimestamp(time_s).astimezone()
