"""Run the experiment that a diagnosis asks for, and diagnose again, until it is decided."""

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from usmbench.cli.bench_session import open_bench, settings_of
from usmbench.cli.live_panel import LivePanel
from usmbench.cli.runs_folder import named_at_the_end, new_run_folder
from usmbench.cli.same_bench import why_another_motor
from usmbench.cli.simulated_motor import MODEL_FILE, SimulatedMotor, last_seed
from usmbench.cli.sweep_run import sweep_new
from usmbench.diagnose.experiment.next_experiment import propose
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.result import Diagnosis
from usmbench.errors import InputError
from usmbench.model.hammerstein import HammersteinModel
from usmbench.report.plain_text import file_name
from usmbench.runs.reader import read_run
from usmbench.runs.record import Record
from usmbench.runs.time_step import alike
from usmbench.settings.bench import SIMULATED, BenchSettings
from usmbench.settings.plan import Plan
from usmbench.settings.plan_file import parse_plan
from usmbench.settings.yaml_source import Source
from usmbench.sweep.interrupts import deferred_interrupts
from usmbench.sweep.preflight import interlocks_of


@dataclass(frozen=True, slots=True)
class Judged:
    """A diagnosis, the runs it rests on, and what would decide it.

    Parameters
    ----------
    diagnosis
        The diagnosis, its next experiment included.
    records
        The runs.
    driven
        Of each experiment that was driven for it, the run and what it was to show.
    """

    diagnosis: Diagnosis
    records: tuple[Record, ...]
    driven: tuple[tuple[str, str], ...] = ()


def judge(records: Sequence[Record], model: HammersteinModel) -> Judged:
    """Diagnose, and propose what would decide.

    Parameters
    ----------
    records
        The runs.
    model
        The model.

    Raises
    ------
    usmbench.errors.InputError
        A run or the model will not do.
    """
    found = diagnose(records, model)
    proposal = propose(found, records, model)
    return Judged(replace(found, next_experiment=proposal), tuple(records))


def check_bench(records: Sequence[Record], bench: str, runs: Path) -> list[str]:
    """Refuse a bench on which an experiment would not continue the runs, before anything moves.

    Parameters
    ----------
    records
        The runs.
    bench
        Bench file, or "simulated".
    runs
        Folder that takes the new runs.

    Returns
    -------
    list of str
        Warnings.

    Raises
    ------
    usmbench.errors.InputError
        The bench file is wrong, it is another bench or motor than that of a run, its windows are of
        another length, or the folder is none.
    """
    settings = settings_of(bench)
    if runs.exists() and not runs.is_dir():
        raise InputError(f"{runs}: is no folder; choose another --runs-folder")
    for record in records:
        why = _another_bench(record, bench, settings)
        if why is not None:
            raise InputError(f"{record.name}: {why}; name the bench that measured it")
    if bench == SIMULATED:
        _check_simulated(records)
    return [
        f"{record.name} does not say on which bench it was measured: taken to be {bench}"
        for record in records
        if "bench" not in record.meta
    ]


def _check_simulated(records: Sequence[Record]) -> None:
    """Refuse runs of more than one simulated motor, or of one that run.yaml cannot make again."""
    for record in records:
        if record.meta.get(MODEL_FILE) is not None:
            raise InputError(
                f"{record.name}: its simulated motor followed a model file; drive the proposed "
                f"plan by usmbench sweep --bench {SIMULATED} --model, and diagnose both runs"
            )
    if len({SimulatedMotor.of_run(r.meta).defects for r in records}) > 1:
        raise InputError(
            "the runs are of different simulated motors (their run.yaml name different defects); "
            "diagnose those of one motor"
        )


def _another_bench(record: Record, bench: str, settings: BenchSettings) -> str | None:
    """Say why a bench cannot be the one that measured a run, or return None."""
    window_s, there_s = record.usual_window_s, settings.window_s
    if not alike(window_s, there_s):
        return f"its windows are {1e3 * window_s:g} ms long, those of {bench} {1e3 * there_s:g} ms"
    return why_another_motor(record.meta, bench, settings)


def decide(
    first: Judged, model: HammersteinModel, bench: str, budget: int, runs: Path
) -> Iterator[Judged]:
    """Yield a judgement after each experiment, until nothing is open or the budget is used.

    Parameters
    ----------
    first
        The judgement to start from.
    model
        The model.
    bench
        Bench file, or "simulated": there the motor is the one that the runs were measured on.
    budget
        Most experiments.
    runs
        Folder that takes the new runs.

    Raises
    ------
    usmbench.errors.InputError
        The bench file is wrong, or a plan is beyond its limits; nothing has moved.
    KeyboardInterrupt
        The user stopped a run; the drive is off and the folder closed.
    usmbench.errors.BenchError
        The bench failed; likewise.
    """
    here, latest = first, max((record.meta for record in first.records), key=last_seed)
    for number in range(1, budget + 1):
        proposal = here.diagnosis.next_experiment
        if proposal is None:
            return
        plan = parse_plan(Source("the proposed plan", proposal["plan"]))
        folder = new_run_folder(f"{file_name(plan.name)}-{number}", runs)
        # The noise of a run in hand once more would look like a cause.
        motor = SimulatedMotor.of_run(latest, later=number)
        _measure(plan, bench, motor, folder)
        driven = (*here.driven, (str(folder), str(proposal["says"])))
        here = replace(judge((*here.records, read_run(folder)), model), driven=driven)
        yield here


def _measure(plan: Plan, bench: str, motor: SimulatedMotor, folder: Path) -> None:
    """Drive a plan into a run folder."""
    simulated = bench == SIMULATED
    with (
        deferred_interrupts(),
        open_bench(bench, testbed_arguments=motor.arguments if simulated else ()) as opened,
        # Standard output may be for the JSON alone.
        named_at_the_end(folder, sys.stderr),
        LivePanel(
            sys.stderr, f"{plan.name} → {folder}", interlocks_of(plan, opened.settings)
        ) as panel,
    ):
        sweep_new(opened, plan, folder, meta=motor.meta if simulated else {}, observer=panel)
