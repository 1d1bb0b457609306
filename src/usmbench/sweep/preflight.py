"""What is refused before anything moves: a plan beyond the limits of the lab or the board."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import fields, replace

from usmbench.errors import InputError
from usmbench.instruments.drive_limits import DriveLimits
from usmbench.instruments.protocol._generated import (
    DDS_CLOCK_HZ,
    DDS_FREQUENCY_BITS,
    DDS_PHASE_BITS,
    FREQUENCY_WORD_MAX,
    FREQUENCY_WORD_MIN,
    HOST_SILENCE_MS,
    PHASE_WORD_MAX,
    PHASE_WORD_MIN,
    PROTOCOL_VERSION,
    Flags,
)
from usmbench.instruments.protocol.messages import Identity
from usmbench.settings.bench import BenchSettings, InterlockSettings
from usmbench.settings.plan import Excitation, Plan
from usmbench.settings.yaml_source import PathInDocument, Source
from usmbench.sweep.excitation import check_excitation
from usmbench.sweep.schedule import HOLD_SETTLE, Dwell
from usmbench.sweep.summary import longest_drive_s

# What a board with this version's firmware says of itself: checked before one is asked.
NOMINAL_BOARD = Identity(
    flags=Flags(0),
    protocol_version=PROTOCOL_VERSION,
    firmware_major=0,
    firmware_minor=0,
    clock_hz=DDS_CLOCK_HZ,
    frequency_word_min=FREQUENCY_WORD_MIN,
    frequency_word_max=FREQUENCY_WORD_MAX,
    phase_word_min=PHASE_WORD_MIN,
    phase_word_max=PHASE_WORD_MAX,
    frequency_bits=DDS_FREQUENCY_BITS,
    phase_bits=DDS_PHASE_BITS,
    host_silence_ms=HOST_SILENCE_MS,
)


def interlocks_of(plan: Plan, bench: BenchSettings) -> InterlockSettings:
    """Return the bench's interlocks, tightened (never widened) by the plan's limits.

    Parameters
    ----------
    plan
        The plan.
    bench
        The bench.
    """
    tighter = {}
    for part in fields(plan.limits):
        wanted = getattr(plan.limits, part.name)
        if wanted is not None:
            tighter[part.name] = min(wanted, getattr(bench.interlocks, part.name))
    return replace(bench.interlocks, **tighter)


def check_plan(plan: Plan, bench: BenchSettings, board: Identity = NOMINAL_BOARD) -> None:
    """Refuse a plan that this bench may not, or cannot, drive.

    Parameters
    ----------
    plan
        The plan.
    bench
        The bench, with the limits of the lab.
    board
        What the board said of itself.

    Raises
    ------
    usmbench.errors.InputError
        Names the line of the plan that is beyond a limit, and the mend.
    """
    limits = DriveLimits(bench.generator.frequency_limits_hz, bench.generator.phase_limits_deg)
    for path, frequency_hz in _frequencies(plan):
        _refuse_beyond(plan, path, lambda f: limits.frequency_word(f, board), frequency_hz)
    for path, phase_deg in _phases(plan):
        _refuse_beyond(plan, path, lambda p: limits.phase_word(p, board), phase_deg)
    if plan.excitation is not None:
        _check_hold(plan.excitation, plan.source)
        check_excitation(plan.excitation, bench.window_s, plan.source)
    _check_drive_time(plan, bench)


def check_dwells(dwells: Iterable[Dwell], bench: BenchSettings, board: Identity, name: str) -> None:
    """Refuse dwells, taken from somewhere else than a plan, that this bench may not drive.

    Parameters
    ----------
    dwells
        The schedule.
    bench
        The bench, with the limits of the lab.
    board
        What the board said of itself.
    name
        Where the dwells come from, for the message.

    Raises
    ------
    usmbench.errors.InputError
        A dwell is beyond a limit.
    """
    limits = DriveLimits(bench.generator.frequency_limits_hz, bench.generator.phase_limits_deg)
    try:
        for dwell in dwells:
            limits.frequency_word(dwell.frequency_hz, board)
            limits.phase_word(dwell.phase_deg, board)
    except InputError as error:
        raise InputError(str(error), file=name) from None


def _refuse_beyond(
    plan: Plan, path: PathInDocument, word: Callable[[float], int], value: float
) -> None:
    try:
        word(value)
    except InputError as error:
        raise plan.source.error(path, str(error)) from None


def _frequencies(plan: Plan) -> Iterator[tuple[PathInDocument, float]]:
    several = isinstance(plan.source.document["frequency_hz"], list)
    for index, frequency_hz in enumerate(plan.frequency_hz):
        yield ("frequency_hz", index) if several else ("frequency_hz",), frequency_hz
    if plan.warm_up is not None and plan.warm_up.frequency_hz is not None:
        yield ("warm_up", "frequency_hz"), plan.warm_up.frequency_hz


def _phases(plan: Plan) -> Iterator[tuple[PathInDocument, float]]:
    """Yield the phases that could be beyond a limit: all of a list, the ends of a range."""
    if plan.warm_up is not None:
        yield ("warm_up", "phase_deg"), plan.warm_up.phase_deg
    for number, one in enumerate(plan.passes):
        place = ("passes", number, "phase_deg")
        if isinstance(plan.source.document["passes"][number]["phase_deg"], list):
            yield from (((*place, i), phase) for i, phase in enumerate(one.phase_deg))
        else:
            yield (*place, "from"), one.phase_deg[0]
            yield (*place, "to"), one.phase_deg[-1]
    if plan.excitation is not None:
        for side in (-1, 1):
            reach_deg = plan.excitation.centre_deg + side * plan.excitation.amplitude_deg
            yield ("excitation", "amplitude_deg"), reach_deg


def _check_hold(excitation: Excitation, source: Source) -> None:
    least = HOLD_SETTLE.min_windows + 1
    if excitation.hold_windows < least:
        message = (
            f"{excitation.hold_windows} leaves no window in which the motor has followed; "
            f"choose at least {least}, or a bench with fewer samples_per_average"
        )
        raise source.error(("excitation", "hold_windows"), message)


def _check_drive_time(plan: Plan, bench: BenchSettings) -> None:
    limit_s = interlocks_of(plan, bench).drive_time_max_s
    planned_s = longest_drive_s(plan, bench.window_s)
    if planned_s > limit_s:
        message = (
            f"drives for {planned_s:.0f} s without a break, drive_time_max_s allows {limit_s:g}; "
            "shorten the plan or raise the limit in the bench file"
        )
        raise plan.source.error((), message)
