"""All checks of a bench, in the order in which one needs the other."""

from collections.abc import Generator
from contextlib import ExitStack

from usmbench.doctor.card import check_card
from usmbench.doctor.finding import Finding, skipped
from usmbench.doctor.motion import MOTION_CHECKS, check_motion
from usmbench.doctor.short_drive import drive_shortly
from usmbench.doctor.wire import check_wire
from usmbench.instruments.nidaq import NiSampleSource
from usmbench.settings.bench import BenchSettings
from usmbench.sweep.operator import Operator


def examine(bench: BenchSettings, operator: Operator, *, move: bool) -> Generator[Finding]:
    """Walk through a bench; whatever is seen, the drive is off at the end.

    Parameters
    ----------
    bench
        The bench.
    operator
        Who sets the load: none is asked for.
    move
        Whether the motor may be driven; without, its outputs are never switched on.

    Yields
    ------
    Finding
        One for each check, as it is made.

    Raises
    ------
    usmbench.errors.BenchError
        The drive could not be switched off.
    """
    with ExitStack() as stack:
        generator = yield from check_wire(bench.generator, stack)
        samples = yield from check_card(bench)
        if generator is None or not samples:
            missing = "the board" if generator is None else "the card"
            yield from skipped(MOTION_CHECKS, f"{missing} cannot be used")
        elif not move:
            yield from skipped(MOTION_CHECKS, "the motor is driven only with --move")
        else:
            with NiSampleSource(bench.daq, bench.temperature, lines=bench.encoder.lines) as source:
                seen = drive_shortly(bench, generator, source, operator)
            yield from check_motion(seen, bench)
