"""Runs of the simulated motor for the identification's benchmarks, by the sweep's own code."""

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.in_process_bench import in_process_bench
from hil_sim.plant import MotorPlant
from usmbench.cli.sweep_run import sweep_new
from usmbench.runs.reader import read_run
from usmbench.runs.record import Record
from usmbench.settings.plan_file import parse_plan
from usmbench.settings.yaml_source import parse_source

Array = NDArray[np.float64]

_COLUMNS = ("t_s", "phase_deg", "speed_rad_s", "window_s", "frequency_hz", "torque_nm")


def head(warm_up_s: int) -> str:
    """Return the beginning of a plan."""
    return (
        "format: usmbench-plan/1\nfrequency_hz: 41000\ntorque_nm: 0\n"
        f"warm_up: {{phase_deg: 90, frequency_hz: 41000, duration_s: {warm_up_s}}}\n"
    )


def staircase(phases_deg: Array, windows: int) -> str:
    """Return the part of a plan that goes up and down a staircase."""
    return (
        f"passes:\n  - phase_deg: {np.round(phases_deg, 3).tolist()}\n    direction: both\n"
        f"dwell: {{windows: {windows}, extend_to_windows: {windows}}}\n"
    )


def points(phases_deg: Array) -> str:
    """Return the part of a plan that measures one settled pair at each phase."""
    return f"passes:\n  - phase_deg: {np.round(phases_deg, 3).tolist()}\n"


def excitation(kind: str, seed: int, duration_s: float) -> str:
    """Return the part of a plan with a random telegraph or a multisine."""
    shape = (
        "levels: 37, switch_probability: 0.5, hold_windows: 10"
        if kind == "telegraph"
        else "hold_windows: 4, band_hz: [0.1, 2], period_s: 10"
    )
    return (
        f"excitation: {{kind: {kind}, seed: {seed}, amplitude_deg: 89.9, "
        f"duration_s: {duration_s}, {shape}}}\n"
    )


def measured(plans: Sequence[str], seed: int) -> list[Record]:
    """Drive plans one after another on one motor, and leave rests and warm-ups out."""
    with (
        tempfile.TemporaryDirectory() as folder,
        in_process_bench(plant=MotorPlant(seed=seed)).opened() as bench,
    ):
        runs = []
        for number, plan in enumerate(plans, start=1):
            run = Path(folder) / f"run-{number}"
            sweep_new(bench, parse_plan(parse_source(plan, "plan.yaml")), run)
            runs.append(_driven(read_run(run), f"motor {seed}, run {number}"))
    return runs


def _driven(record: Record, name: str) -> Record:
    """Return the rows with the drive on after the warm-up."""
    assert record.sweep is not None
    drive_on = np.asarray(record.extra["drive_on"], dtype=np.float64)
    rows = (record.sweep >= 0.0) & (drive_on != 0.0)
    kept = {column: getattr(record, column)[rows] for column in _COLUMNS}
    return Record(name, **kept, pairs=record.pairs)


def scaled(record: Record) -> Record:
    """Return the run with the highest settled speed as its unit of speed."""
    pairs = record.pairs
    assert pairs is not None
    unit = float(np.max(np.abs(pairs.speed_rad_s)))
    return replace(
        record,
        speed_rad_s=record.speed_rad_s / unit,
        pairs=replace(pairs, speed_rad_s=pairs.speed_rad_s / unit),
    )
