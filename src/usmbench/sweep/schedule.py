"""From a plan to its dwells, one at a time, so that a long plan takes no more memory."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, islice

from usmbench.settings.plan import Pass, Plan, Settle, WarmUp
from usmbench.sweep.excitation import held_phases

WARM_UP = -1
# Windows of a held excitation that do not count: the command falls into the first, and after a
# second (of 10 ms) a lag of 3.5 ms has passed.
HOLD_SETTLE = Settle(min_windows=2, over_windows=0)


@dataclass(frozen=True, slots=True)
class Dwell:
    """One phase held at one operating point.

    Parameters
    ----------
    number
        Number in the plan, from 0; `WARM_UP` for the warm-up.
    sweep
        Number of the pass, from 0; -1 for the warm-up.
    phase_deg, frequency_hz, torque_nm
        What is commanded.
    direction
        +1 where φ rises, -1 where it falls.
    windows
        Windows of the dwell.
    extend_to_windows
        Windows after which it ends though it has not settled.
    settle
        When it counts as settled; None where no pair is wanted.
    """

    number: int
    sweep: int
    phase_deg: float
    frequency_hz: float
    torque_nm: float
    direction: int
    windows: int
    extend_to_windows: int
    settle: Settle | None


@dataclass(frozen=True, slots=True)
class _Point:
    """A phase of a pass, before its operating point is known."""

    sweep: int
    phase_deg: float
    direction: int


def operating_points(plan: Plan) -> Iterator[tuple[float, float]]:
    """Yield the (frequency in Hz, torque in N·m) of a plan in the order they are driven.

    Parameters
    ----------
    plan
        The plan.
    """
    if plan.outer == "torque_nm":
        yield from ((f, torque) for torque in plan.torque_nm for f in plan.frequency_hz)
    else:
        yield from ((f, torque) for f in plan.frequency_hz for torque in plan.torque_nm)


def schedule(plan: Plan, window_s: float, first_dwell: int = 0) -> Iterator[Dwell]:
    """Yield the warm-up, where there is one, and the dwells of a plan.

    Parameters
    ----------
    plan
        The plan.
    window_s
        Duration of one window.
    first_dwell
        The first dwell to be driven, where a resumed run takes up.
    """
    dwells = islice(_dwells(plan, window_s), first_dwell, None)
    first = next(dwells, None)
    if first is None:
        return
    if plan.warm_up is not None:
        yield _warm_up(plan.warm_up, window_s, first)
    yield first
    yield from dwells


def _warm_up(warm_up: WarmUp, window_s: float, first: Dwell) -> Dwell:
    windows = max(1, round(warm_up.duration_s / window_s))
    return Dwell(
        number=WARM_UP,
        sweep=-1,
        phase_deg=warm_up.phase_deg,
        frequency_hz=warm_up.frequency_hz or first.frequency_hz,
        torque_nm=first.torque_nm,
        direction=1,
        windows=windows,
        extend_to_windows=windows,
        settle=None,
    )


def _dwells(plan: Plan, window_s: float) -> Iterator[Dwell]:
    number = 0
    first_sweep = 0
    for frequency_hz, torque_nm in operating_points(plan):
        sweep = first_sweep
        for point in _points(plan, window_s, first_sweep):
            windows, extend_to_windows, settle = _timing(plan)
            yield Dwell(
                number,
                point.sweep,
                point.phase_deg,
                frequency_hz,
                torque_nm,
                point.direction,
                windows,
                extend_to_windows,
                settle,
            )
            number += 1
            sweep = point.sweep
        first_sweep = sweep + 1


def _timing(plan: Plan) -> tuple[int, int, Settle | None]:
    if plan.excitation is None:
        return plan.dwell.windows, plan.dwell.extend_to_windows, plan.dwell.settle
    hold = plan.excitation.hold_windows
    return hold, hold, HOLD_SETTLE if hold > HOLD_SETTLE.min_windows else None


def _points(plan: Plan, window_s: float, first_sweep: int) -> Iterator[_Point]:
    """Yield the phases at one operating point."""
    if plan.excitation is not None:
        phases = held_phases(plan.excitation, window_s, plan.source)
        yield from _directed(phases, first_sweep)
        return
    sweep = first_sweep
    for one in plan.passes:
        ways = ways_of(one)
        for _ in range(one.repeats):
            for way in ways:
                yield from _directed(iter(way), sweep)
                sweep += 1


def ways_of(one: Pass) -> tuple[Sequence[float], ...]:
    """Return the phases of a pass in the order they are driven, a sequence for each way.

    Parameters
    ----------
    one
        The pass.
    """
    if one.direction == "as_listed":
        return (one.phase_deg,)
    rising = sorted(one.phase_deg)
    falling = rising[::-1]
    ways = {"rising": (rising,), "falling": (falling,), "both": (rising, falling)}
    return ways[one.direction]


def _directed(phases_deg: Iterator[float], sweep: int) -> Iterator[_Point]:
    """Yield each phase with the way it was reached; the first with the way it is left."""
    first = next(phases_deg)
    second = list(islice(phases_deg, 1))
    direction = -1 if second and second[0] < first else 1
    last = first
    for phase_deg in chain([first], second, phases_deg):
        if phase_deg != last:
            direction = 1 if phase_deg > last else -1
        yield _Point(sweep, phase_deg, direction)
        last = phase_deg
