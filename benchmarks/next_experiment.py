"""Does the proposed experiment decide? Delay and hysteresis in a triangle at one rate.

A motor with a hidden delay, or with friction that sticks, is driven through a triangle at one rate,
in which a delay and a hysteresis shift the curve alike. What diagnose cannot tell, the experiment
that it proposes is driven for, on the same simulated motor, and all runs are diagnosed together.

    python benchmarks/next_experiment.py            # every size, three motors
    python benchmarks/next_experiment.py --small    # one of each
"""

import argparse
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.in_process_bench import in_process_bench
from hil_sim.defects import Defect, defective_plant, parse_defect
from hil_sim.plant import PlantParameters
from usmbench.cli.deciding_runs import judge
from usmbench.cli.sweep_run import sweep_new
from usmbench.diagnose.reference import with_knowledge
from usmbench.diagnose.result import Diagnosis
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.reader import read_run
from usmbench.runs.record import Record
from usmbench.settings.plan import Plan
from usmbench.settings.plan_file import load_plan, parse_plan
from usmbench.settings.yaml_source import Source

HIDDEN = ("command_queue=20", "command_queue=40", "command_queue=80", "sticky_friction=60")
MOTORS = (1, 2, 3)
BUDGET = 3
# A multiple of what the generator can set, 360/4096 degrees, so that every step is the same.
_STEP_DEG = 6 * 360.0 / 4096.0
_REACH = 168


def triangle() -> Plan:
    """Return the triangle: one rate, and neither a jump at its start nor at its end."""
    there = np.r_[0:_REACH, _REACH:-_REACH:-1, -_REACH:1]
    document = {
        "format": "usmbench-plan/1",
        "name": "triangle",
        "frequency_hz": 41_000,
        "passes": [{"phase_deg": (_STEP_DEG * there).tolist(), "direction": "as_listed"}],
        "dwell": {
            "windows": 4,
            "extend_to_windows": 4,
            "settle": {"min_windows": 1, "over_windows": 2},
        },
    }
    return parse_plan(Source("triangle.yaml", document))


@dataclass(frozen=True, slots=True)
class Step:
    """What a diagnosis said after so many experiments.

    Parameters
    ----------
    verdict
        The verdict.
    named
        The named causes, each with its alternatives.
    proposal
        What was proposed next, in words, with its odds; empty where nothing was.
    """

    verdict: str
    named: tuple[tuple[str, ...], ...]
    proposal: str

    @classmethod
    def of(cls, found: Diagnosis) -> "Step":
        """Return the step that a diagnosis is."""
        named = tuple((cause.name, *cause.alternatives) for cause in found.causes)
        proposal = found.next_experiment
        says = ""
        if proposal is not None:
            odds = f"{proposal['odds_before']:.2f} → {proposal['odds_after']:.2f}"
            says = f"{proposal['says']} Odds {odds}."
        return cls(found.verdict, named, says)


class Motor:
    """One motor in a folder: identified healthy, then with something hidden in it."""

    def __init__(self, folder: Path, seed: int):
        self._folder, self._seed, self._runs = folder, seed, 0
        drawn = PlantParameters.draw(np.random.default_rng([seed, 1]))
        self._healthy = PlantParameters() if seed == MOTORS[0] else drawn
        reference = self._drive(load_plan("phase-sweep"), ())
        identified = identify_fast([reference], FastOptions())
        self._model: HammersteinModel = with_knowledge(identified.model, [reference])

    def decided(self, defect: Defect) -> Iterator[Step]:
        """Yield what is said of the triangle, and after each experiment."""
        records = [self._drive(triangle(), (defect,))]
        for number in range(BUDGET + 1):
            judged = judge(records, self._model)
            yield Step.of(judged.diagnosis)
            proposal = judged.diagnosis.next_experiment
            if proposal is None or number == BUDGET:
                return
            plan = parse_plan(Source("the proposed plan", proposal["plan"]))
            records.append(self._drive(plan, (defect,)))

    def _drive(self, plan: Plan, defects: Sequence[Defect]) -> Record:
        """Drive a plan on the simulated testbed."""
        self._runs += 1
        folder = self._folder / f"{self._seed}-{self._runs}"
        plant = defective_plant(self._healthy, defects, seed=100 * self._seed + self._runs)
        with in_process_bench(plant=plant).opened() as bench:
            sweep_new(bench, plan, folder)
        return read_run(folder)


def main(arguments: Sequence[str] | None = None) -> list[list[Step]]:
    """Print a line a step, and return them by case.

    Parameters
    ----------
    arguments
        The command line; None takes it from the process.
    """
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--small", action="store_true", help="one motor, one size of each")
    small = parser.parse_args(arguments).small
    told, cases = 0, []
    for seed in MOTORS[:1] if small else MOTORS:
        with tempfile.TemporaryDirectory() as folder:
            motor = Motor(Path(folder), seed)
            for hidden in HIDDEN[1::2] if small else HIDDEN:
                defect = parse_defect(hidden)
                print(f"motor {seed}, {hidden} ({defect.cause})")
                steps = list(motor.decided(defect))
                for number, step in enumerate(steps):
                    sets = "; ".join(" or ".join(names) for names in step.named) or "no cause"
                    print(f"  after {number} experiments: {step.verdict}, {sets}. {step.proposal}")
                first = steps[-1].named[0] if steps[-1].named else ()
                told += first == (defect.cause,)
                cases.append(steps)
    print(f"{told} of {len(cases)} named alone in the end")
    return cases


if __name__ == "__main__":
    main()
