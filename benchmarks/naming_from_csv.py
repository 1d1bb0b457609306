"""Plain runs in CSV files, short ones among them, through the commands: what is named.

    python benchmarks/naming_from_csv.py [--seed 1] [--draws 8] [--small]

Where naming_campaign.py drives the simulated testbed, here a motor of a few lines is read into one
or three reference files and a measured one, of 200, 600 or 2000 windows of 5, 10 or 30 ms, averaged
over or sampled at their ends, by the same plan or another, with white or coloured noise. `usmbench
identify` and `usmbench diagnose` see the files and nothing else.
"""

import argparse
import contextlib
import io
import json
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from benchmarks.plain_motor import (
    PlainMotor,
    Wrong,
    motor_of_any_curve,
    size_of,
    speed_rad_s,
)
from benchmarks.plain_outcome import NOTHING, OUTSIDE, Conditions, Outcome, report
from benchmarks.plain_runs import KINDS, noise_rad_s, write_csv
from usmbench.cli.main import main as usmbench

Array = NDArray[np.float64]

CAUSES = (
    "phase_offset",
    "gain_asymmetry",
    "speed_scale",
    "thermal_drift",
    "dead_zone_hysteresis",
    "load_torque",
    "missed_counts",
    "encoder_eccentricity",
    "transport_delay",
    "slow_dynamics",
    "phase_quantisation",
    "count_glitches",
)
_TIMES_NOISE = (1.5, 0.5)
_HEALTHY = 16  # times as many draws as a cause has


def conditions_of(rng: np.random.Generator) -> Conditions:
    """Draw the conditions.

    Parameters
    ----------
    rng
        Where chance comes from.
    """
    return Conditions(
        str(rng.choice(KINDS)),
        int(rng.choice([200, 600, 2000])),
        float(rng.choice([60.0, 90.0, 120.0])),
        float(rng.choice([0.005, 0.01, 0.03])),
        float(rng.choice([0.01, 0.03, 0.08])),
        float(rng.choice([0.0, 0.0, 0.6])),
        int(rng.choice([1, 3])),
        str(rng.choice(["", str(rng.choice(KINDS))])),
        bool(rng.integers(2)),
    )


def draw(seed: int, number: int, cause: str, times_noise: float) -> Outcome:
    """Draw a motor, its runs and what is wrong; identify and diagnose.

    Parameters
    ----------
    seed, number
        What fixes the draw, beside the cause and its strength.
    cause
        The cause to hide, "outside" or "nothing".
    times_noise
        Root mean square of what it does, over the noise's.
    """
    rng = np.random.default_rng([seed, number, crc32(cause.encode()), round(100 * times_noise)])
    motor, how, phase_deg, size = _drawn(rng, cause, times_noise)
    wrong = Wrong() if cause == NOTHING else Wrong(cause, size)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        references = [str(folder / f"healthy{k}.csv") for k in range(how.n_references)]
        for path in references:
            _measure(Path(path), motor, how, how.reference_deg(rng), Wrong(), rng)
        _measure(folder / "measured.csv", motor, how, phase_deg, wrong, rng)
        names, verdict = diagnosed(folder, references)
    return Outcome(cause, times_noise, how, names, verdict)


def _drawn(
    rng: np.random.Generator, cause: str, times_noise: float
) -> tuple[PlainMotor, Conditions, Array, float]:
    """Draw motor and conditions until some size of the cause does as much."""
    while True:
        motor, how = motor_of_any_curve(rng), conditions_of(rng)
        phase_deg = how.phase_deg(rng)
        if cause == NOTHING:
            return motor, how, phase_deg, 0.0
        size = _size(motor, how, phase_deg, cause, times_noise)
        if size is not None:
            return motor, how, phase_deg, size


def _size(
    motor: PlainMotor, how: Conditions, phase_deg: Array, cause: str, times_noise: float
) -> float | None:
    """Size at which a cause does as much; None for none."""

    def speed(wrong: Wrong) -> Array:
        rng = np.random.default_rng(0)
        return speed_rad_s(motor, phase_deg, how.window_s, wrong, rng, sampled=how.sampled)[0]

    return size_of(speed, cause, times_noise * how.noise_rad_s)


def _measure(
    path: Path,
    motor: PlainMotor,
    how: Conditions,
    phase_deg: Array,
    wrong: Wrong,
    rng: np.random.Generator,
) -> None:
    speed, angle_rad = speed_rad_s(motor, phase_deg, how.window_s, wrong, rng, sampled=how.sampled)
    noisy = speed + noise_rad_s(how.n, how.noise_rad_s, how.colour, rng)
    write_csv(path, phase_deg, noisy, angle_rad, how.window_s)


def diagnosed(folder: Path, references: Sequence[str]) -> tuple[tuple[tuple[str, ...], ...], str]:
    """Return names with their alternatives, and the verdict on `measured.csv`.

    Parameters
    ----------
    folder
        Where that is.
    references
        Files to identify the model from.
    """
    model, result = str(folder / "model.yaml"), folder / "result.json"
    measured = str(folder / "measured.csv")
    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        failed = usmbench(["identify", *references, "--out", model]) or usmbench(
            ["diagnose", measured, "--model", model, "--json", str(result)]
        )
    if failed:
        return (), said.getvalue().strip()
    found = json.loads(result.read_text(encoding="utf-8"))
    names = tuple((c["name"], *c["alternatives"]) for c in found["causes"])
    return names, str(found["verdict"])


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--draws", type=int, default=8, help="of each cause and strength")
    parser.add_argument("--wrong", action="store_true", help="list what came out wrong, too")
    parser.add_argument("--small", action="store_true", help="one draw of three causes")
    arguments = parser.parse_args(argv)
    n_causes, n_strengths, draws = (3, 1, 1) if arguments.small else (None, None, arguments.draws)
    causes, strengths = (*CAUSES, OUTSIDE)[:n_causes], _TIMES_NOISE[:n_strengths]
    wanted = [(c, s, k) for s in strengths for c in causes for k in range(draws)]
    wanted += [(NOTHING, strengths[0], k) for k in range(_HEALTHY * draws)]
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        jobs = [pool.submit(draw, arguments.seed, k, c, s) for c, s, k in wanted]
        outcomes = [job.result() for job in jobs]
    report(outcomes)
    if arguments.wrong:
        print(*(outcome for outcome in outcomes if not outcome.right), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
