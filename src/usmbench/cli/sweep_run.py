"""One run on an open bench, from the first row to the closed folder."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from usmbench.cli.bench_session import Bench
from usmbench.cli.same_plan import check_same_plan
from usmbench.instruments.protocol.messages import Identity
from usmbench.runs.stop_request import StopSign
from usmbench.runs.writer import RunWriter
from usmbench.settings.bench import BenchSettings, InterlockSettings
from usmbench.settings.bench_file import bench_document
from usmbench.settings.plan import Plan
from usmbench.sweep.controller import Instruments, SweepController
from usmbench.sweep.interrupts import deferred_interrupts
from usmbench.sweep.observer import Observer
from usmbench.sweep.preflight import check_plan, interlocks_of
from usmbench.sweep.schedule import Dwell, schedule
from usmbench.sweep.summary import n_windows
from usmbench.sweep.window_reader import Start


@dataclass(frozen=True, slots=True)
class Job:
    """What is driven.

    Parameters
    ----------
    dwells
        The schedule.
    n_windows
        Windows that are planned in all.
    interlocks
        When the drive must go off.
    ask_operator
        Whether the operator is asked to set each load.
    start
        Where the rows begin.
    """

    dwells: Iterable[Dwell]
    n_windows: int
    interlocks: InterlockSettings
    ask_operator: bool
    start: Start = field(default_factory=Start)


def plan_job(
    plan: Plan, bench: BenchSettings, first_dwell: int = 0, start: Start | None = None
) -> Job:
    """Return the job that a plan makes on a bench.

    Parameters
    ----------
    plan
        The plan.
    bench
        The bench.
    first_dwell
        The first dwell to be driven, where a run is taken up again.
    start
        Where the rows begin, there; None for a new run.
    """
    interlocks = interlocks_of(plan, bench)
    return Job(
        schedule(plan, bench.window_s, first_dwell),
        n_windows(plan, interlocks, bench.window_s, first_dwell),
        interlocks,
        plan.ask_operator,
        start or Start(),
    )


def encoder_meta(bench: BenchSettings) -> dict[str, float]:
    """Return what run.yaml says of the encoder and its windows.

    Parameters
    ----------
    bench
        The bench.
    """
    return {
        "counts_per_rev": bench.counts_per_rev,
        "sample_rate_hz": bench.daq.sample_rate_hz,
        "samples_per_average": bench.daq.samples_per_average,
    }


def run_meta(bench: BenchSettings, board: Identity, **further: Any) -> dict[str, Any]:
    """Return what run.yaml says of a run on a bench.

    Parameters
    ----------
    bench
        The bench.
    board
        What the board said of itself.
    **further
        Further keys, such as the plan.
    """
    return {
        "motor": bench.motor,
        "encoder": encoder_meta(bench),
        "firmware": f"{board.firmware_major}.{board.firmware_minor}",
        "generator": {"phase_step_deg": 360.0 / (1 << board.phase_bits)},
        "bench": bench_document(bench),
        **further,
    }


def measure(bench: Bench, job: Job, writer: RunWriter, observer: Observer | None = None) -> None:
    """Run a job into a run folder; the folder is closed and says how the run ended.

    Parameters
    ----------
    bench
        The open bench.
    job
        What is driven.
    writer
        The run folder.
    observer
        Is told of every window and pair, or None.

    Raises
    ------
    KeyboardInterrupt
        The user stopped the run; the drive is off and the folder closed.
    usmbench.errors.BenchError
        The bench failed; likewise.
    """
    with deferred_interrupts():
        outcome = "completed"
        try:
            instruments = Instruments(bench.generator, bench.source, bench.operator)
            controller = SweepController(
                instruments,
                bench.settings,
                job.interlocks,
                writer,
                observer=observer,
                ask_operator=job.ask_operator,
                start=job.start,
                check_stop=StopSign(writer.folder).check,
            )
            controller.run(job.dwells, job.n_windows)
        except KeyboardInterrupt:
            outcome = "interrupted"
            raise
        except BaseException as error:
            outcome = f"failed: {error}"
            raise
        finally:
            writer.close(outcome)


def sweep_new(
    bench: Bench,
    plan: Plan,
    folder: Path,
    *,
    raw: bool = False,
    meta: Mapping[str, Any] | None = None,
    observer: Observer | None = None,
) -> None:
    """Drive a plan into a new run folder.

    Parameters
    ----------
    bench
        The open bench.
    plan
        The plan; refused before the folder is made where the board cannot drive it.
    folder
        The folder to make.
    raw
        Whether the counter samples are kept.
    meta
        Further keys for run.yaml.
    observer
        Is told of every window and pair, or None.

    Raises
    ------
    usmbench.errors.InputError
        The plan is beyond a limit, or the folder cannot be made; nothing has moved.
    KeyboardInterrupt
        The user stopped the run; the drive is off and the folder closed.
    usmbench.errors.BenchError
        The bench failed; likewise.
    """
    settings = bench.settings
    check_plan(plan, settings, bench.generator.identity)
    head = run_meta(settings, bench.generator.identity, plan=plan.source.document, **(meta or {}))
    with deferred_interrupts():
        temperature = settings.temperature is not None
        writer = RunWriter.create(folder, head, temperature=temperature, raw=raw)
        measure(bench, plan_job(plan, settings), writer, observer)


def sweep_again(
    bench: Bench, plan: Plan, folder: Path, *, observer: Observer | None = None
) -> None:
    """Take up an interrupted run at the dwell where it stopped.

    The warm-up is driven again; the rows go on behind those there are, and their time by the pause.

    Parameters
    ----------
    bench
        The open bench.
    plan
        The plan of the run.
    folder
        The run folder.
    observer
        Is told of every window and pair, or None.

    Raises
    ------
    usmbench.errors.InputError
        The run is complete, was measured by another plan, or cannot be continued; nothing has
        moved.
    KeyboardInterrupt
        The user stopped the run; the drive is off and the folder closed.
    usmbench.errors.BenchError
        The bench failed; likewise.
    """
    check_plan(plan, bench.settings, bench.generator.identity)
    check_same_plan(folder, plan, bench.settings.window_s)
    with deferred_interrupts():
        writer = RunWriter.resume(folder)
        stopped = writer.stopped_at
        pause_s = max(bench.rested_s, bench.settings.window_s)
        start = Start(writer.resumes_at_s(pause_s), stopped.angle_rad)
        job = plan_job(plan, bench.settings, stopped.last_dwell + 1, start)
        measure(bench, job, writer, observer)
