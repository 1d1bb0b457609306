"""What a plan amounts to, counted without running through it."""

from collections.abc import Iterator
from itertools import groupby, islice
from math import ceil

from usmbench.settings.bench import BenchSettings, InterlockSettings
from usmbench.settings.plan import Plan
from usmbench.sweep.excitation import n_holds
from usmbench.sweep.schedule import operating_points, ways_of

# Windows without drive before the first command: they show that nothing moves.
WINDOWS_BEFORE = 5
PASSES_SHOWN = 20


def windows_after(interlocks: InterlockSettings, window_s: float) -> int:
    """Return the number of windows after the last dwell that show that the motor has stopped.

    Parameters
    ----------
    interlocks
        The limits.
    window_s
        Duration of one window.
    """
    return ceil(interlocks.motion_off_after_s / window_s) + 3


def n_dwells(plan: Plan, window_s: float) -> int:
    """Return the number of dwells of a plan, the warm-up left out.

    Parameters
    ----------
    plan
        The plan.
    window_s
        Duration of one window.
    """
    return len(plan.frequency_hz) * len(plan.torque_nm) * _dwells_at_point(plan, window_s)


def n_windows(
    plan: Plan, interlocks: InterlockSettings, window_s: float, first_dwell: int = 0
) -> int:
    """Return the number of windows of a plan, those without drive included.

    Parameters
    ----------
    plan
        The plan.
    interlocks
        The limits, which say how long the end is watched.
    window_s
        Duration of one window.
    first_dwell
        The first dwell to be driven, where a run is taken up again.
    """
    dwells = max(0, n_dwells(plan, window_s) - first_dwell)
    driven = _warm_up_windows(plan, window_s) + dwells * windows_per_dwell(plan)
    return WINDOWS_BEFORE + driven + windows_after(interlocks, window_s)


def windows_per_dwell(plan: Plan) -> int:
    """Return the windows of each dwell that settles in time.

    Parameters
    ----------
    plan
        The plan.
    """
    return plan.dwell.windows if plan.excitation is None else plan.excitation.hold_windows


def longest_drive_s(plan: Plan, window_s: float) -> float:
    """Return the longest time for which a plan drives without a break.

    The drive pauses where the operator changes the load.

    Parameters
    ----------
    plan
        The plan.
    window_s
        Duration of one window.
    """
    torques_nm = (torque_nm for _, torque_nm in operating_points(plan))
    points = max(len(list(same)) for _, same in groupby(torques_nm))
    windows = points * _dwells_at_point(plan, window_s) * windows_per_dwell(plan)
    return (windows + _warm_up_windows(plan, window_s)) * window_s


def describe(plan: Plan, bench: BenchSettings, interlocks: InterlockSettings) -> Iterator[str]:
    """Yield the lines that a dry run shows: passes, limits, duration.

    Parameters
    ----------
    plan
        The plan.
    bench
        The bench.
    interlocks
        The bench's limits, tightened by the plan's.
    """
    window_s = bench.window_s
    yield f"plan       {plan.name}"
    if plan.warm_up is not None:
        yield f"warm-up    φ = {plan.warm_up.phase_deg:g}° for {plan.warm_up.duration_s:g} s"
    for sweep, line in enumerate(islice(_passes(plan, window_s), PASSES_SHOWN)):
        yield f"pass {sweep:<5d} {line}"
    further = _n_passes(plan) - PASSES_SHOWN
    if further > 0:
        yield f"           and {further} more"
    yield from _limits(plan, bench, interlocks)
    dwells = n_dwells(plan, window_s)
    extend = "" if plan.excitation else f", up to {plan.dwell.extend_to_windows} until settled"
    yield (
        f"dwells     {dwells} of {windows_per_dwell(plan)} windows of "
        f"{1000 * window_s:g} ms{extend}"
    )
    duration_s = n_windows(plan, interlocks, window_s) * window_s
    longer = ""
    if plan.excitation is None and plan.dwell.extend_to_windows > plan.dwell.windows:
        more = dwells * (plan.dwell.extend_to_windows - plan.dwell.windows)
        longer = f", {duration_s + more * window_s:.1f} s where no dwell settles"
    yield f"duration   {duration_s:.1f} s{longer}"


def _dwells_at_point(plan: Plan, window_s: float) -> int:
    if plan.excitation is not None:
        return n_holds(plan.excitation, window_s)
    return sum(one.repeats * len(ways_of(one)) * len(one.phase_deg) for one in plan.passes)


def _warm_up_windows(plan: Plan, window_s: float) -> int:
    return 0 if plan.warm_up is None else max(1, round(plan.warm_up.duration_s / window_s))


def _n_passes(plan: Plan) -> int:
    at_point = sum(one.repeats * len(ways_of(one)) for one in plan.passes)
    if plan.excitation is not None:
        at_point += 1
    return len(plan.frequency_hz) * len(plan.torque_nm) * at_point


def _passes(plan: Plan, window_s: float) -> Iterator[str]:
    for frequency_hz, torque_nm in operating_points(plan):
        point = f"{frequency_hz:g} Hz  {torque_nm:g} N·m"
        if plan.excitation is not None:
            low_deg, high_deg = _reach(plan)
            yield (
                f"{point}  {plan.excitation.kind} {low_deg:g}° … {high_deg:g}°  "
                f"{n_holds(plan.excitation, window_s)} holds"
            )
        for one in plan.passes:
            for _ in range(one.repeats):
                for way in ways_of(one):
                    yield f"{point}  φ {way[0]:g}° … {way[-1]:g}°  {len(way)} phases"


def _reach(plan: Plan) -> tuple[float, float]:
    """Return the lowest and the highest phase."""
    phases = [] if plan.warm_up is None else [plan.warm_up.phase_deg]
    if plan.excitation is not None:
        centre_deg, amplitude_deg = plan.excitation.centre_deg, plan.excitation.amplitude_deg
        phases += [centre_deg - amplitude_deg, centre_deg + amplitude_deg]
    for one in plan.passes:
        phases += one.phase_deg
    return min(phases), max(phases)


def _limits(plan: Plan, bench: BenchSettings, interlocks: InterlockSettings) -> Iterator[str]:
    low_deg, high_deg = _reach(plan)
    lab_low_deg, lab_high_deg = bench.generator.phase_limits_deg
    low_hz, high_hz = min(plan.frequency_hz), max(plan.frequency_hz)
    lab_low_hz, lab_high_hz = bench.generator.frequency_limits_hz
    yield f"phase      {low_deg:g}° … {high_deg:g}°  (limits {lab_low_deg:g}° … {lab_high_deg:g}°)"
    yield f"frequency  {low_hz:g} … {high_hz:g} Hz  (limits {lab_low_hz:g} … {lab_high_hz:g} Hz)"
    yield (
        f"stops at   {interlocks.overspeed_rad_s:g} rad/s, {interlocks.temperature_max_c:g} °C, "
        f"{interlocks.drive_time_max_s:g} s of drive without a break"
    )
