"""`usmbench replay --bench`: a run's commands driven again."""

import argparse
import sys
from pathlib import Path

from usmbench.cli.bench_session import Bench, open_bench
from usmbench.cli.live_panel import LivePanel
from usmbench.cli.recorded_commands import operator_set_loads, recorded_dwells
from usmbench.cli.runs_folder import check_absent, named_at_the_end, new_run_folder
from usmbench.cli.sweep_run import Job, measure, run_meta
from usmbench.runs.reader import read_run
from usmbench.runs.record import Record
from usmbench.runs.writer import RunWriter
from usmbench.settings.bench import BenchSettings
from usmbench.sweep.interrupts import deferred_interrupts
from usmbench.sweep.observer import Observer
from usmbench.sweep.preflight import check_dwells
from usmbench.sweep.schedule import Dwell
from usmbench.sweep.summary import WINDOWS_BEFORE, windows_after


def replay_on_bench(args: argparse.Namespace) -> int:
    """Drive a run's commands again and print the new run folder, however it ends.

    Parameters
    ----------
    args
        The parsed arguments: `recorded`, `bench` and `out`.

    Raises
    ------
    usmbench.errors.InputError
        The run cannot be read, asks for more than this bench allows, or the folder exists; nothing
        has moved.
    KeyboardInterrupt
        The user stopped the run; the drive is off and the folder closed.
    usmbench.errors.BenchError
        The bench failed; likewise.
    """
    record = read_run(args.recorded)
    folder = args.out or new_run_folder("replay")
    check_absent(folder)
    with deferred_interrupts(), open_bench(args.bench) as bench:
        title = f"replay of {record.name} → {folder}"
        with (
            named_at_the_end(folder),
            LivePanel(sys.stderr, title, bench.settings.interlocks) as panel,
        ):
            drive_again(bench, record, folder, observer=panel)
    return 0


def drive_again(
    bench: Bench, record: Record, folder: Path, *, observer: Observer | None = None
) -> None:
    """Drive a run's commands again, into a new run folder.

    Parameters
    ----------
    bench
        The open bench.
    record
        The run.
    folder
        The folder to make.
    observer
        Is told of every window and pair, or None.

    Raises
    ------
    usmbench.errors.InputError
        The run asks for more than this bench allows, or the folder cannot be made.
    usmbench.errors.BenchError
        The bench failed; the drive is off and the folder closed.
    """
    settings, board = bench.settings, bench.generator.identity
    dwells = recorded_dwells(record, settings.window_s)
    check_dwells(dwells, settings, board, record.name)
    head = run_meta(settings, board, replay_of=_identity(record))
    writer = RunWriter.create(folder, head, temperature=settings.temperature is not None, raw=False)
    asked = operator_set_loads(record, dwells)
    job = Job(dwells, _n_windows(dwells, settings), settings.interlocks, asked)
    measure(bench, job, writer, observer)


def _identity(record: Record) -> str:
    return str(record.meta.get("id", record.name))


def _n_windows(dwells: list[Dwell], settings: BenchSettings) -> int:
    driven = sum(dwell.windows for dwell in dwells)
    return WINDOWS_BEFORE + driven + windows_after(settings.interlocks, settings.window_s)
