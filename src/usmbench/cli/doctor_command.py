"""``usmbench doctor``: what is wrong with a bench, and what to do about it."""

import argparse
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import asdict

from usmbench.cli.json_output import write_json
from usmbench.cli.simulated_bench import SimulatedOperator, simulated_settings, start_testbed
from usmbench.doctor.examination import examine
from usmbench.doctor.finding import Finding
from usmbench.errors import BenchError
from usmbench.report.plain_text import printable
from usmbench.runs.output_paths import check_outputs
from usmbench.settings.bench import SIMULATED, BenchSettings
from usmbench.settings.bench_file import load_bench
from usmbench.sweep.interrupts import deferred_interrupts
from usmbench.sweep.operator import Operator, TerminalOperator


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments.

    Parameters
    ----------
    parser
        The subcommand's parser.
    """
    parser.add_argument(
        "--bench",
        metavar="BENCH.yaml",
        help=f"bench file, or {SIMULATED}; without, the port is searched and the card is Dev1",
    )
    parser.add_argument(
        "--move",
        action="store_true",
        help="drive the motor for some seconds each way; it must be free to turn",
    )
    parser.add_argument("--json", metavar="FILE", help="the findings as JSON; - is standard output")


def run(args: argparse.Namespace) -> int:
    """Examine a bench.

    Parameters
    ----------
    args
        The parsed arguments.

    Returns
    -------
    int
        0 where the bench can be used, else that of a bench that failed.

    Raises
    ------
    usmbench.errors.InputError
        The bench file is wrong, or the findings cannot be written.
    KeyboardInterrupt
        The user stopped it; the drive is off.
    usmbench.errors.BenchError
        The drive could not be switched off.
    """
    check_outputs({"--json": args.json}, [args.bench])
    findings = []
    with (
        deferred_interrupts() as interrupts,
        _bench(args.bench) as (settings, operator),
        closing(examine(settings, operator, move=args.move)) as examination,
    ):
        for finding in examination:
            findings.append(finding)
            if args.json != "-":
                print(_text(finding), flush=True)
            interrupts.check()
    failed = sum(finding.status == "failed" for finding in findings)
    if args.json:
        checks = [asdict(finding) for finding in findings]
        write_json(args.json, {"bench": settings.name, "failed": failed, "checks": checks})
    if args.json != "-":
        print(_verdict(findings, failed))
    return BenchError.exit_status if failed else 0


@contextmanager
def _bench(bench: str | None) -> Iterator[tuple[BenchSettings, Operator]]:
    """Give the settings to examine, with the simulated testbed up where it is asked for."""
    if bench == SIMULATED:
        with start_testbed(["--lock-step"]) as testbed:
            settings = simulated_settings(BenchSettings(), testbed.port, testbed.daq_address)
            yield settings, SimulatedOperator(testbed)
    else:
        settings = BenchSettings() if bench is None else load_bench(bench)
        yield settings, TerminalOperator(sys.stderr)


def _text(finding: Finding) -> str:
    lines = [f"{finding.status:8} {finding.check:21} {printable(finding.saw)}"]
    if finding.do:
        lines.append(f"{'':8} {'':21} → {printable(finding.do)}")
    return "\n".join(lines)


def _verdict(findings: list[Finding], failed: int) -> str:
    if failed:
        return f"{failed} of {len(findings)} checks failed; mend the first one first"
    if any(finding.status == "skipped" for finding in findings):
        return "nothing failed, but not everything was looked at"
    return "the bench is fit to be used"
