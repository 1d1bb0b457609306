"""A bench, real or simulated, open for as long as a command needs it."""

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import TextIO

from usmbench.cli.simulated_bench import SimulatedOperator, simulated_settings, start_testbed
from usmbench.errors import LostCountsError
from usmbench.instruments.generator import SignalGenerator
from usmbench.instruments.nidaq import NiSampleSource
from usmbench.instruments.samples import SampleSource
from usmbench.runs.pauses import COOLED_S
from usmbench.settings.bench import SIMULATED, BenchSettings
from usmbench.settings.bench_file import load_bench
from usmbench.sweep.operator import Operator, TerminalOperator


@dataclass(frozen=True, slots=True)
class Bench:
    """The instruments of an open bench.

    Parameters
    ----------
    settings
        What the bench file says.
    generator
        The signal generator board, identified, its drive off.
    source
        The encoder's samples, not yet started.
    operator
        Who sets the load.
    clock
        Seconds that pass on this bench.
    rested_s
        For how long at least its motor has rested when the bench opens.
    """

    settings: BenchSettings
    generator: SignalGenerator
    source: SampleSource
    operator: Operator
    clock: Callable[[], float] = time.monotonic
    rested_s: float = 0.0


def settings_of(bench: str) -> BenchSettings:
    """Return what a bench file says, or the simulated bench before it is started.

    Parameters
    ----------
    bench
        Bench file, or "simulated".

    Raises
    ------
    usmbench.errors.InputError
        The bench file is wrong.
    """
    return BenchSettings(name=SIMULATED) if bench == SIMULATED else load_bench(bench)


@contextmanager
def open_bench(
    bench: str | BenchSettings,
    *,
    testbed_arguments: Sequence[str] = (),
    frame_log: TextIO | None = None,
) -> Iterator[Bench]:
    """Open a bench; whatever happens, the drive is off when the context ends.

    Parameters
    ----------
    bench
        Bench file, the settings of one, or "simulated" for the embedded testbed.
    testbed_arguments
        Further arguments for the embedded testbed's process.
    frame_log
        Text stream that takes every frame on the line.

    Raises
    ------
    usmbench.errors.InputError
        The bench file is wrong, or the port or the card is not there.
    usmbench.errors.BenchError
        The board or the card does not answer.
    """
    with ExitStack() as stack:
        operator: Operator = TerminalOperator(sys.stderr)
        rested_s = 0.0
        if bench == SIMULATED:
            stack.enter_context(_where_its_limits_are())
            testbed = stack.enter_context(start_testbed(["--lock-step", *testbed_arguments]))
            settings = simulated_settings(BenchSettings(), testbed.port, testbed.daq_address)
            # Its motor is made anew, cold and at rest, however short the wait was.
            operator, rested_s = SimulatedOperator(testbed), COOLED_S
        else:
            settings = bench if isinstance(bench, BenchSettings) else load_bench(bench)
        # The card first: where it is missing the board has not been touched yet, and on the way out
        # the drive goes off while the card still watches.
        source = stack.enter_context(
            NiSampleSource(settings.daq, settings.temperature, lines=settings.encoder.lines)
        )
        generator = stack.enter_context(
            SignalGenerator.open(settings.generator, frame_log=frame_log)
        )
        yield Bench(settings, generator, source, operator, rested_s=rested_s)


@contextmanager
def _where_its_limits_are() -> Iterator[None]:
    """Say how a limit of the simulated bench is changed, where a message names its bench file."""
    try:
        yield
    except LostCountsError as error:
        # The error itself is raised again: its notes tell what failed after it.
        error.args = (
            f"{error} (the simulated bench has none: start python -m hil_sim --lock-step, with the "
            "defect, and give --bench a file with the port and the address that it prints)",
        )
        raise
