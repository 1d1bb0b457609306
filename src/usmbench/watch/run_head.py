"""What run.yaml says that the live page needs, and what follows from it."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from usmbench.errors import InputError
from usmbench.runs.columns import RUN_FILE
from usmbench.runs.meta import read_meta, said_motor, said_window_s
from usmbench.runs.time_step import UNKNOWN_S
from usmbench.settings.bench_file import parse_bench
from usmbench.settings.plan_file import parse_plan
from usmbench.settings.yaml_source import Source
from usmbench.sweep.preflight import interlocks_of
from usmbench.sweep.summary import n_windows


@dataclass(frozen=True, slots=True)
class RunHead:
    """What the live page says of a run besides its rows.

    Parameters
    ----------
    name
        Folder or file.
    words
        What stands in run.yaml, as words for the page: plan, motor, started …
    outcome
        How the run ended, None while it goes on.
    window_s
        Duration of its windows.
    planned_windows
        Windows of the plan, None where there is no plan.
    can_be_stopped
        Whether a process may be measuring it.
    """

    name: str
    words: Mapping[str, str]
    outcome: str | None
    window_s: float
    planned_windows: int | None
    can_be_stopped: bool


def bare_head(path: Path) -> RunHead:
    """Return what is known of a bare CSV.

    Parameters
    ----------
    path
        The file.
    """
    return RunHead(str(path), {}, "a bare file", UNKNOWN_S, None, can_be_stopped=False)


def read_head(folder: Path) -> RunHead:
    """Return what run.yaml says of a run.

    Parameters
    ----------
    folder
        The run folder.

    Raises
    ------
    usmbench.errors.InputError
        run.yaml cannot be read.
    """
    meta = read_meta(folder)
    outcome = meta.get("exit")
    bench, encoder = _mapping(meta, "bench"), _mapping(meta, "encoder")
    generator, daq = _mapping(bench, "generator"), _mapping(bench, "daq")
    plan = _mapping(meta, "plan")
    words = {
        "motor": said_motor(meta),
        "plan": plan.get("name")
        or (f"replay of {meta['replay_of']}" if "replay_of" in meta else None),
        "bench": bench.get("name"),
        "started": meta.get("started"),
        "stopped": meta.get("stopped"),
        "port": generator.get("port"),
        "firmware": meta.get("firmware"),
        "device": daq.get("device"),
        "sample_rate_hz": encoder.get("sample_rate_hz"),
    }
    said = {key: str(value) for key, value in words.items() if value is not None}
    return RunHead(
        str(folder),
        said,
        None if outcome is None else str(outcome),
        said_window_s(meta) or UNKNOWN_S,
        _planned_windows(folder, meta),
        can_be_stopped=outcome is None,
    )


def _mapping(meta: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    value = meta.get(key)
    return value if isinstance(value, dict) else {}


def _planned_windows(folder: Path, meta: Mapping[str, Any]) -> int | None:
    """Return the windows of the run's plan on its bench, None where the run has no whole ones."""
    file = str(folder / RUN_FILE)
    try:
        plan = parse_plan(Source(f"{file} (plan)", meta["plan"]))
        bench = parse_bench(Source(f"{file} (bench)", meta["bench"]))
    except (KeyError, InputError):
        return None
    return n_windows(plan, interlocks_of(plan, bench), bench.window_s)
