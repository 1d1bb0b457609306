"""Hide a cause in a motor, drive the sweep, diagnose the run folder, and count what is named.

    python benchmarks/naming_campaign.py [--motors 25] [--draws 12] [--seed 1] [--small]

Every draw is fixed by the seeds. The diagnosis sees run folders and a model identified from the
healthy motor's reference runs, nothing else. `--runs DIR` keeps the run folders, and takes those
that are there already; `--out FILE` keeps the record, `--table FILE` prints it again.
"""

import argparse
import json
import multiprocessing
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from benchmarks.campaign_bench import REFERENCE_S, SMALL_REFERENCE_S, MotorBench, references
from benchmarks.campaign_draws import (
    LENGTHS_S,
    SMALL_LENGTHS_S,
    STRENGTHS,
    WANDERS,
    Choice,
    draws,
    motor_of,
)
from benchmarks.campaign_tables import Row, report, wrong_ones
from hil_sim.defects import CATALOGUE
from usmbench.errors import UsmbenchError


@dataclass(frozen=True, slots=True)
class Campaign:
    """What every motor of a campaign shares.

    Parameters
    ----------
    seed
        Seed of everything.
    n_draws, n_wire
        Draws of a motor, and how many of them go over the wire.
    wanders
        Run-to-run wanders that the motors take in turn.
    choice
        What is drawn from.
    runs
        Folder of the runs; None keeps none.
    reference_s
        Duration of each of the runs that a motor is identified on.
    """

    seed: int
    n_draws: int
    n_wire: int
    wanders: tuple[float, ...] = WANDERS
    choice: Choice = field(default_factory=Choice)
    runs: Path | None = None
    reference_s: float = REFERENCE_S


def work(campaign: Campaign, number: int) -> Iterator[str]:
    """Identify one motor, diagnose its draws, yield a line of the record for each."""
    motor = motor_of(campaign.seed, number, campaign.wanders)
    with tempfile.TemporaryDirectory() as folder:
        runs = campaign.runs or Path(folder) / "runs"
        runs.mkdir(exist_ok=True)
        bench = MotorBench(runs, Path(folder), motor, references(campaign.reference_s))
        for draw in draws(
            campaign.seed, number, campaign.n_draws, campaign.n_wire, campaign.choice
        ):
            yield bench.diagnosed(draw).line()


def whole(campaign: Campaign, number: int) -> list[str]:
    """Return the record of a motor, or what there is of it where it breaks off."""
    lines: list[str] = []
    try:
        lines.extend(work(campaign, number))
    except (UsmbenchError, RuntimeError, ArithmeticError, ValueError):
        # One broken motor must not end an hour's campaign; the table counts its draws as gone.
        traceback.print_exc()
    return lines


def run(campaign: Campaign, motors: range, processes: int, minutes: float) -> Iterator[str]:
    """Yield the record until all motors are done or the time is over."""
    ends_s = time.monotonic() + 60.0 * minutes
    if processes == 1:
        for number in motors:
            for line in work(campaign, number):
                yield line
                if time.monotonic() > ends_s:
                    return
        return
    context = multiprocessing.get_context("spawn")
    with context.Pool(processes, maxtasksperchild=4) as pool:
        for lines in pool.imap_unordered(partial(whole, campaign), motors):
            yield from lines
            if time.monotonic() > ends_s:
                return


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--motors", type=int, default=25)
    parser.add_argument("--first", type=int, default=0, help="number of the first motor")
    parser.add_argument("--draws", type=int, default=12, help="draws of each motor")
    parser.add_argument("--through-wire", type=int, default=2, help="draws a motor over pty, gRPC")
    parser.add_argument("--wanders", type=float, nargs="+", default=list(WANDERS))
    parser.add_argument("--strengths", type=float, nargs="+", default=list(STRENGTHS))
    parser.add_argument("--lengths", type=float, nargs="+", help=f"in s; {LENGTHS_S} unless given")
    parser.add_argument(
        "--mechanisms",
        nargs="+",
        choices=["nothing", *CATALOGUE],
        default=[],
        metavar="MECHANISM",
        help="hide only these, each alone, in turn; nothing is one of them",
    )
    parser.add_argument(
        "--two-frequencies", type=float, default=0.5, help="share of draws that drive both"
    )
    parser.add_argument("--minutes", type=float, default=120.0, help="end after that")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--runs", type=Path, help="folder that keeps the runs")
    parser.add_argument("--out", type=Path, help="write one JSON object a draw to this file")
    parser.add_argument("--wrong", action="store_true", help="list what came out wrong, too")
    parser.add_argument("--small", action="store_true", help="one motor, three draws")
    parser.add_argument("--table", type=Path, help="print the tables of a record, drive nothing")
    arguments = parser.parse_args(argv)
    if arguments.table is not None:
        rows = [json.loads(line) for line in arguments.table.read_text("utf-8").splitlines()]
    else:
        rows = _driven(arguments)
    report(rows)
    if arguments.wrong:
        wrong_ones(rows)
    return 0 if rows else 1


def _driven(arguments: argparse.Namespace) -> list[Row]:
    """Run the campaign and keep its record."""
    n_draws, processes = arguments.draws, arguments.processes
    motors = range(arguments.first, arguments.first + arguments.motors)
    usual_s = SMALL_LENGTHS_S if arguments.small else LENGTHS_S
    lengths_s = tuple(arguments.lengths or usual_s)
    # How a motor warms is known for as long as it was watched.
    reference_s = max(REFERENCE_S, *lengths_s)
    if arguments.small:
        motors, n_draws, processes, reference_s = motors[:1], 3, 1, SMALL_REFERENCE_S
    campaign = Campaign(
        arguments.seed,
        n_draws,
        arguments.through_wire,
        tuple(arguments.wanders),
        Choice(
            tuple(arguments.strengths),
            tuple(arguments.mechanisms),
            arguments.two_frequencies,
            lengths_s,
        ),
        arguments.runs,
        reference_s,
    )
    lines = []
    with tempfile.NamedTemporaryFile("w") as nowhere:
        kept = arguments.out or Path(nowhere.name)
        with kept.open("w", encoding="utf-8") as record:
            for line in run(campaign, motors, processes, arguments.minutes):
                lines.append(line)
                print(line, file=record, flush=True)
    return [json.loads(line) for line in lines]


if __name__ == "__main__":
    sys.exit(main())
