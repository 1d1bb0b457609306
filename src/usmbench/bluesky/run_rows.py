"""The rows of a run folder, out of the events of a bluesky run."""

import csv
import io
from collections.abc import Mapping, Sequence
from typing import Any, Final

from usmbench.errors import InputError
from usmbench.runs.columns import PAIR_COLUMNS, PAIRS_FILE, WINDOW_COLUMNS, WINDOWS_FILE

PRIMARY: Final = "primary"
WINDOWS: Final = "windows"
_NEEDED: Final = ("phase_deg", "speed_rad_s")

Row = dict[str, Any]


class RunRows:
    """Collects events, whatever the order in which their streams come."""

    def __init__(self) -> None:
        self._streams: dict[str, str] = {}
        self._rows: dict[str, list[Row]] = {PRIMARY: [], WINDOWS: []}

    def declare(self, descriptor: Mapping[str, Any]) -> None:
        """Take an event descriptor.

        Parameters
        ----------
        descriptor
            The document.
        """
        self._streams[descriptor["uid"]] = str(descriptor.get("name", PRIMARY))

    def add(self, event: Mapping[str, Any]) -> None:
        """Take an event; those of other streams are passed over.

        Parameters
        ----------
        event
            The document.

        Raises
        ------
        usmbench.errors.InputError
            Its descriptor did not come.
        """
        stream = self._streams.get(event["descriptor"])
        if stream is None:
            raise InputError("an event came without its descriptor; give those of one whole run")
        if stream in self._rows:
            self._rows[stream].append({**event["data"], "time": event["time"]})

    def texts(self, started_s: float) -> dict[str, str]:
        """Return the files of a run folder, by name.

        Parameters
        ----------
        started_s
            When the run started, in seconds since the epoch.

        Raises
        ------
        usmbench.errors.InputError
            There is neither a window nor a pair with phase and speed.
        """
        pairs = [_timed(row, started_s) for row in self._rows[PRIMARY] if _is_measured(row)]
        windows = [_timed(row, started_s) for row in self._rows[WINDOWS] if _is_measured(row)]
        if not windows and not pairs:
            raise InputError(
                "no event has phase_deg and speed_rad_s: scan [encoder] over phase, or give the "
                "documents of a run"
            )
        texts = {WINDOWS_FILE: _text(windows or pairs, WINDOW_COLUMNS)}
        directed = _with_direction(pairs) if pairs else []
        # Without all of them, readers derive the pairs from the windows.
        if directed and set(PAIR_COLUMNS) <= directed[0].keys():
            texts[PAIRS_FILE] = _text(directed, PAIR_COLUMNS)
        return texts


def _is_measured(row: Row) -> bool:
    return all(name in row for name in _NEEDED)


def _timed(row: Row, started_s: float) -> Row:
    """Return the row with its time in the run in place of that of the day."""
    time_s = row.pop("time") - started_s
    return {"t_s": time_s} | row


def _with_direction(pairs: list[Row]) -> list[Row]:
    """Say whether φ rose to each pair, where the events do not."""
    if "direction" in pairs[0]:
        return pairs
    phases_deg = [row["phase_deg"] for row in pairs]
    direction = 1
    if len(phases_deg) > 1 and phases_deg[1] < phases_deg[0]:
        direction = -1
    directed = []
    for before_deg, row in zip([phases_deg[0], *phases_deg], pairs, strict=False):
        if row["phase_deg"] != before_deg:
            direction = 1 if row["phase_deg"] > before_deg else -1
        directed.append(row | {"direction": direction})
    return directed


def _text(rows: Sequence[Row], first: Sequence[str]) -> str:
    """Return rows as CSV, with the columns in the order in which a sweep writes them."""
    present = list(dict.fromkeys(name for row in rows for name in row))
    names = [name for name in first if name in present]
    names += [name for name in present if name not in names]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(names)
    writer.writerows([[_cell(row.get(name, "nan")) for name in names] for row in rows])
    return text.getvalue()


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return value
    return f"{float(value):.12g}"
