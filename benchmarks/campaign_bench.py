"""One motor of the naming campaign: identify it, hide a cause, diagnose, keep what came out."""

from collections.abc import Iterable, Iterator
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace
from functools import cached_property
from io import StringIO
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from benchmarks.campaign_draws import Draw
from benchmarks.campaign_effects import Effects, Seen
from benchmarks.campaign_outcome import Outcome
from benchmarks.campaign_runs import FREQUENCIES_HZ, PLANS, Excited, Measured, Motor
from benchmarks.campaign_sizes import noise_of, not_far_out, square_of, strength_of
from benchmarks.told_test import told_length
from hil_sim.defects import Defect
from usmbench.cli.main import main as usmbench
from usmbench.diagnose.fitting.gain import gain_of_blocks
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.pipeline import diagnose, searched
from usmbench.diagnose.residual.own_effects import cut_beside_own
from usmbench.errors import UsmbenchError
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.model_file import read_model, write_model
from usmbench.model.replay import replay_record
from usmbench.runs.reader import read_run
from usmbench.runs.record import Record

Array = NDArray[np.float64]

REFERENCE_S: Final = 40.0
SMALL_REFERENCE_S: Final = 8.0
_BESIDE_HZ: Final = (-25.0, 0.0, 25.0)  # near enough for the slope, far enough for the noise
_FRESH: Final = 5000
_SMALL: Final = 1.0  # noise
_FRESH_EVERY: Final = 4  # a fresh run costs as much as the draw itself


def references(duration_s: float = REFERENCE_S) -> Iterator[Excited]:
    """Yield what a healthy motor is driven with, to be identified.

    Every other run takes the frequencies backwards, else the warm-up would pass for the slope of
    the resonance curve.

    Parameters
    ----------
    duration_s
        Duration of each run: four at the drive frequencies, four at these and their neighbours,
        which show that slope.
    """
    near_hz = tuple(f + step_hz for f in FREQUENCIES_HZ for step_hz in _BESIDE_HZ)
    runs = [
        *((kind, FREQUENCIES_HZ) for kind in (*PLANS, PLANS[0])),
        *(("multisine", near_hz) for _ in range(4)),
    ]
    for k, (kind, frequencies_hz) in enumerate(runs):
        yield Excited(kind, duration_s, 900 + k, frequencies_hz[:: -1 if k % 2 else 1])


class MotorBench:
    """One motor and its model, identified on healthy runs.

    Parameters
    ----------
    runs
        Folder of the runs, which are driven where they are not there yet.
    folder
        Folder for models and results.
    motor
        The motor.
    references
        What drives the runs that it is identified on.
    """

    def __init__(self, runs: Path, folder: Path, motor: Motor, references: Iterable[Excited]):
        self._runs, self._folder, self._motor = runs, folder, motor
        self.effects = Effects(runs, motor)
        self.model = folder / "model.yaml"
        driven = [Measured(motor, excited, excited.seed).folder(runs) for excited in references]
        _command("identify", *driven, "--out", self.model)

    def diagnosed(self, draw: Draw) -> Outcome:
        """Hide, measure, diagnose."""
        motor, excited, defects = self._motor, draw.excited, draw.hidden.made
        outcome = Outcome(
            motor.seed,
            draw.number,
            draw.hidden,
            excited.kind,
            excited.duration_s,
            motor.noise_correlation_s,
            motor.wander,
            draw.wire,
            len(excited.frequencies_hz),
        )
        try:
            # A bench that sees the defect itself, as an interlock sees a dead channel, stops here.
            run = self.measured(excited, draw.number, defects, wire=draw.wire)
            if defects:
                self._compare(outcome, read_run(run), draw)
            outcome.take(self.diagnosis(run), excited.frequencies_hz)
        except UsmbenchError as error:
            outcome.error = str(error)
            return outcome
        if outcome.named and defects and draw.number % _FRESH_EVERY == 0:
            self._on_another_run(outcome, draw)
        return outcome

    def measured(
        self,
        excited: Excited,
        run_seed: int,
        defects: tuple[Defect, ...] = (),
        *,
        wire: bool = False,
    ) -> Path:
        """Return the folder of a run of this motor."""
        return Measured(self._motor, excited, run_seed, defects, wire).folder(self._runs)

    def diagnosis(self, run: Path) -> dict[str, Any]:
        """Return what diagnose says of a run; leave the extended model beside the plain one."""
        # Not by the command, which goes on to look for the next experiment.
        result = diagnose([read_run(run)], self._plain)
        write_model(self._extended, result.extended)
        return result.to_json()

    def searched(self, record: Record) -> Found:
        """Return what a diagnosis of a run finds before it says so."""
        return searched(cut_beside_own([record], self._plain)[0], self._plain)

    @cached_property
    def _plain(self) -> HammersteinModel:
        return read_model(self.model)

    @property
    def _extended(self) -> Path:
        return self._folder / "extended.yaml"

    def _compare(self, outcome: Outcome, record: Record, draw: Draw) -> None:
        """Hold what is hidden against the noise."""
        defects, healthy = draw.hidden.made, self.effects.speeds_rad_s(draw.excited)
        noise, (_, inside) = noise_of(healthy), _error(self._plain, record)
        rows = inside & not_far_out(np.max(np.abs(noise), axis=0))
        noise_rad_s = float(np.sqrt(np.mean(noise[:, rows] ** 2)))
        wanders = self.effects.wanders(draw.excited)

        def strength(seen: Seen) -> float:
            usual = rows & seen.well
            effects, ways = seen.effects_rad_s[:, usual], wanders[usual]
            return strength_of(effects, ways, noise_rad_s, by_chance=seen.by_chance)

        seen = self.effects.seen(draw, defects)
        outcome.strength = outcome.weakest = strength(seen)
        if len(defects) > 1:
            outcome.weakest = min(strength(self.effects.seen(draw, (d,))) for d in defects)
        square = square_of(seen.effects_rad_s[:, inside], by_chance=seen.by_chance)
        outcome.rms = float(np.sqrt(square / np.count_nonzero(inside))) / noise_rad_s
        small = draw.hidden.group == "single" and outcome.strength < _SMALL
        if small and not seen.by_chance:
            found = self.searched(record)
            outcome.told = told_length(seen.effects_rad_s, record, found, seen.well)

    def _on_another_run(self, outcome: Outcome, draw: Draw) -> None:
        """Score the extended model, and the plain one with the true effect, on a run unseen."""
        defects, day = draw.hidden.made, _FRESH + draw.number
        excited = replace(draw.excited, seed=draw.excited.seed + _FRESH)
        record = read_run(self.measured(excited, day, defects))
        extended = read_model(self._extended)
        (plain, _), (better, _) = _error(self._plain, record), _error(extended, record)
        truly = plain - self.effects.effects_rad_s(excited, defects).mean(axis=0)
        # The windows that a diagnosis of this run would score.
        problem = self.searched(record).problem
        ((stretch,), (mask,)) = problem.stretches, problem.masks
        rows = stretch.use & mask
        floor = problem.noise.calm_rad_s(stretch)[rows]
        outcome.fresh_gain = _gain(plain[rows], better[rows], floor)
        outcome.oracle_gain = _gain(plain[rows], truly[rows], floor)


def _error(model: HammersteinModel, record: Record) -> tuple[Array, NDArray[np.bool_]]:
    """Error of a model's free run, and the rows inside the model's range."""
    simulation = replay_record(record, model).simulation
    return record.speed_rad_s - simulation.speed_rad_s, simulation.inside


def _gain(before: Array, after: Array, floor: Array) -> float:
    """Share of the mean square above the floor that is gone, as diagnose counts it."""
    squares = [float(np.sum(e**2)) for e in (before, after, floor)]
    return gain_of_blocks(np.array([*squares, before.size])[:, None]).gain


def _command(*words: str | Path) -> None:
    """Run a usmbench command in this process; raise what it complained of."""
    complaint = StringIO()
    with redirect_stdout(StringIO()), redirect_stderr(complaint):
        status = usmbench([str(word) for word in words])
    if status:
        raise RuntimeError(complaint.getvalue().strip())
