"""Runs for campaigns: a motor drawn by seed, with or without defects, through the real sweep."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

import numpy as np

from benchmarks.in_process_bench import in_process_bench
from hil_sim.defects import Defect, defective_plant
from hil_sim.defects.defect import wandering
from hil_sim.defects.paths import WiredPlant
from hil_sim.plant import PlantParameters
from hil_sim.plant.disc import DiscError
from hil_sim.running import RunningTestbed
from usmbench.cli.bench_session import Bench, open_bench
from usmbench.cli.simulated_bench import simulated_settings
from usmbench.cli.sweep_run import sweep_new
from usmbench.settings.bench import BenchSettings
from usmbench.settings.plan import Plan
from usmbench.settings.plan_file import parse_plan
from usmbench.settings.yaml_source import parse_source

PLANS = ("staircase", "telegraph", "multisine")
FREQUENCY_HZ = 41_000.0
FREQUENCIES_HZ = (40_050.0, FREQUENCY_HZ)  # either side of the resonance
# Lost counts are among what is looked for: they must not end the run.
_BENCH = BenchSettings(name="campaign")
COUNT_RAD = 2.0 * np.pi / _BENCH.counts_per_rev
COUNT_RAD_S = COUNT_RAD / _BENCH.window_s  # one count in a window
_SETTINGS = replace(_BENCH, interlocks=replace(_BENCH.interlocks, index_error_max_counts=None))
_STAIRS = 25
_SHORTEST_DWELL = 16  # windows: what a plan of settled pairs asks for
# A campaign runs for an hour beside whatever else this machine does.
_WIRE_SILENCE_S = 120.0


@dataclass(frozen=True, slots=True)
class Motor:
    """A motor on its bench.

    Parameters
    ----------
    seed
        Which motor.
    noise_correlation_s
        Colour of its torque noise.
    wander
        Relative wander of gain and dead zone from run to run.
    quiet
        Whether it runs without torque noise and wander, to tell an effect from them.
    clamp_error
        Relative change of the quiet motor's clamping torque, which makes the dead zone.
    """

    seed: int
    noise_correlation_s: float = 0.01
    wander: float = 0.0
    quiet: bool = False
    clamp_error: float = 0.0

    def parameters(self, run_seed: int) -> PlantParameters:
        """Return the motor as it is in one run."""
        drawn = PlantParameters.draw(np.random.default_rng([self.seed, 1]))
        rotor = replace(drawn.rotor, noise_correlation_s=self.noise_correlation_s)
        if self.quiet:
            clamp_limit_nm = drawn.contact.clamp_limit_nm * (1.0 + self.clamp_error)
            contact = replace(drawn.contact, clamp_limit_nm=clamp_limit_nm)
            return replace(drawn, contact=contact, rotor=replace(rotor, noise_nm=0.0))
        rng = np.random.default_rng([self.seed, 2, run_seed])
        return wandering(replace(drawn, rotor=rotor), rng, self.wander)


@dataclass(frozen=True, slots=True)
class Excited:
    """What is driven: a plan's kind, its length over all frequencies, its seed, the frequencies."""

    kind: str
    duration_s: float
    seed: int
    frequencies_hz: tuple[float, ...] = (FREQUENCY_HZ,)

    def plan(self) -> Plan:
        """Return the plan."""
        head = (
            f"format: usmbench-plan/1\nfrequency_hz: {list(self.frequencies_hz)}\n"
            "warm_up: {phase_deg: 90, duration_s: 2}\n"
        )
        return parse_plan(parse_source(head + self._body(), f"{self.kind}.yaml"))

    @property
    def name(self) -> str:
        """What tells it from others."""
        name = f"{self.kind}-{self.duration_s:g}s-{self.seed}"
        if self.frequencies_hz == (FREQUENCY_HZ,):
            return name
        return f"{name}-{'+'.join(f'{f:g}' for f in self.frequencies_hz)}Hz"

    def _body(self) -> str:
        duration_s = self.duration_s / len(self.frequencies_hz)
        if self.kind == "staircase":
            # Up and down; the phases move by less than a step from seed to seed.
            offset_deg = float(np.random.default_rng(self.seed).uniform(-1.5, 1.5))
            each_way = 100.0 * duration_s / 2.0
            stairs = min(_STAIRS, int(each_way / _SHORTEST_DWELL))
            phases = np.round(np.linspace(-88.0, 88.0, stairs) + offset_deg, 3)
            windows = round(each_way / stairs)
            return (
                f"passes:\n  - phase_deg: {phases.tolist()}\n    direction: both\n"
                f"dwell: {{windows: {windows}, extend_to_windows: {windows}}}\n"
            )
        shape = (
            "levels: 19, switch_probability: 0.5, hold_windows: 5"
            if self.kind == "telegraph"
            else "hold_windows: 4, band_hz: [0.1, 5], period_s: 10"
        )
        return (
            f"excitation: {{kind: {self.kind}, seed: {self.seed}, amplitude_deg: 89, "
            f"duration_s: {duration_s}, {shape}}}\n"
        )


@dataclass(frozen=True, slots=True)
class Measured:
    """Everything that fixes a run.

    Parameters
    ----------
    motor, excited, run_seed
        Which motor, driven how, on which day.
    defects
        What is wrong with it.
    wire
        Whether it is driven over the pseudo-terminal and the DAQ client.
    """

    motor: Motor
    excited: Excited
    run_seed: int
    defects: tuple[Defect, ...] = ()
    wire: bool = False

    @property
    def name(self) -> str:
        """Name of the run's folder: the same for the same rows."""
        motor, excited = self.motor, self.excited
        parts = [
            f"{motor.seed}-{1e3 * motor.noise_correlation_s:g}ms-{motor.wander:g}",
            *(["quiet"] if motor.quiet else []),
            *([f"clamp{motor.clamp_error:+g}"] if motor.clamp_error else []),
            f"{excited.name}-{self.run_seed}",
            *(f"{defect.mechanism}={defect.size:.6g}" for defect in self.defects),
            *(["wire"] if self.wire else []),
        ]
        return "_".join(parts)

    def folder(self, parent: Path) -> Path:
        """Return the run folder; drive the sweep where it is not there yet.

        Parameters
        ----------
        parent
            Where the runs are.
        """
        folder = parent / self.name
        if not folder.exists():
            plant = defective_plant(
                self.motor.parameters(self.run_seed), self.defects, seed=self.run_seed
            )
            opened = _through_wire(plant) if self.wire else _in_process(plant)
            unfinished = parent / f"{self.name}.part"
            shutil.rmtree(unfinished, ignore_errors=True)
            with opened as bench:
                sweep_new(bench, self.excited.plan(), unfinished)
            unfinished.rename(folder)
        return folder


class TurnedDisc(Defect):
    """No defect: the disc sits on the shaft turned by `size` counts."""

    mechanism: ClassVar[str] = "turned_disc"
    cause: ClassVar[str] = ""
    unit: ClassVar[str] = "counts"
    typical: ClassVar[float] = 0.5

    def disc_error(self) -> DiscError:
        """Return the pattern's angle beyond the shaft's, in rad."""
        return lambda angle_rad: np.full_like(angle_rad, self.size * COUNT_RAD)


@contextmanager
def _in_process(plant: WiredPlant) -> Iterator[Bench]:
    with in_process_bench(settings=_SETTINGS, plant=plant).opened() as bench:
        yield bench


@contextmanager
def _through_wire(plant: WiredPlant) -> Iterator[Bench]:
    with RunningTestbed(plant, lock_step=True) as running:
        settings = simulated_settings(_SETTINGS, running.port, running.daq_address)
        patient = replace(settings.daq, no_data_timeout_s=_WIRE_SILENCE_S)
        with open_bench(replace(settings, daq=patient)) as bench:
            yield bench
