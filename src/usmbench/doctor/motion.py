"""The motor, driven shortly: whether it turns, which way, and what a revolution counts."""

from collections.abc import Iterator
from math import pi
from typing import Final

from usmbench.doctor.finding import Finding, skipped
from usmbench.doctor.short_drive import NO_MOTION_COUNTS, Driven, ShortDrive
from usmbench.errors import DaqError
from usmbench.instruments.index_check import CountsPerRev, measure_counts_per_rev
from usmbench.instruments.nidaq_tasks import COUNTER_BITS
from usmbench.settings.bench import BenchSettings

MOTION_CHECKS: Final = ("motion", "encoder direction", "counts per revolution")
# One sample at each end of a revolution.
_SPREAD_COUNTS: Final = 2
_DEAD_CHANNEL: Final = (
    "one encoder channel is dead: look at both channels with an oscilloscope, at their wires and "
    "at the encoder's 5 V"
)


def check_motion(seen: ShortDrive, bench: BenchSettings) -> Iterator[Finding]:
    """Judge a short drive.

    Parameters
    ----------
    seen
        What it showed.
    bench
        What the bench file says.

    Yields
    ------
    Finding
        One for each check.
    """
    ways = [way for way in (seen.driven(1), seen.driven(-1)) if way.phase_deg]
    turns = any(abs(way.travelled_rad) > NO_MOTION_COUNTS * _rad_per_count(bench) for way in ways)
    yield _check_turning(seen, ways, turns=turns)
    if not turns:
        yield from skipped(MOTION_CHECKS[1:], "the encoder shows no motion to judge")
        return
    yield _check_direction(ways)
    if len({way.speed_rad_s > 0.0 for way in ways}) < len(ways):
        yield from skipped(MOTION_CHECKS[2:], "the counter does not know where it turned back")
        return
    yield _check_counts(seen, bench)


def _check_turning(seen: ShortDrive, ways: list[Driven], *, turns: bool) -> Finding:
    if not turns and (ways or seen.error is None):
        return _no_motion(ways)
    speeds = _speeds(ways)
    if seen.error is not None:
        saw = f"{speeds}; stopped: {seen.error}" if speeds else str(seen.error)
        return Finding("motion", "failed", saw, "mend what stopped the drive, then ask again")
    return Finding("motion", "ok", speeds)


def _no_motion(ways: list[Driven]) -> Finding:
    """Say why nothing moved, as far as the counter knows."""
    edges = sum(way.edges for way in ways)
    if not ways:
        saw = "generator.phase_limits_deg leaves no phase at which a motor turns"
        do = "widen generator.phase_limits_deg"
    elif edges > NO_MOTION_COUNTS:
        saw = f"the counter changed {edges} times and went nowhere"
        do = _DEAD_CHANNEL
    else:
        saw = f"no counts while driven ({_speeds(ways)})"
        do = (
            "see whether the shaft turns: if so, look at the coupling and the encoder's cable; if "
            "not, at the amplifier's supply and at its inputs"
        )
    return Finding("motion", "failed", saw, do)


def _speeds(ways: list[Driven]) -> str:
    return ", ".join(f"{way.speed_rad_s:+.2f} rad/s at φ = {way.phase_deg:+g}°" for way in ways)


def _rad_per_count(bench: BenchSettings) -> float:
    return 2.0 * pi / bench.counts_per_rev


def _check_direction(ways: list[Driven]) -> Finding:
    """Hold the sign of the speed against the sign of the phase."""
    saw = _speeds(ways)
    agrees = {way.speed_rad_s * way.phase_deg > 0.0 for way in ways}
    if agrees == {True}:
        return Finding("encoder direction", "ok", f"positive speed at positive phase ({saw})")
    if agrees == {False}:
        do = (
            "change the sign of encoder.sign in the bench file, or swap the encoder's channels A "
            "and B; then see by eye that positive phase turns the shaft the way you call positive"
        )
        return Finding("encoder direction", "failed", f"it runs backwards ({saw})", do)
    do = (
        "the sign of the speed is lost: look at channel B, which gives the direction, and at the "
        "generators, whose phase may not follow what is set"
    )
    return Finding("encoder direction", "failed", f"the same sign both ways ({saw})", do)


def _check_counts(seen: ShortDrive, bench: BenchSettings) -> Finding:
    """Hold the counts between index pulses against the bench file."""
    check, expected = MOTION_CHECKS[2], bench.counts_per_rev
    if bench.daq.index_counter is None:
        do = "wire the index and set daq.index_counter: without it nobody sees counts that are lost"
        return Finding(check, "skipped", f"no index is wired; the bench file says {expected}", do)
    try:
        found = measure_counts_per_rev(seen.blocks, COUNTER_BITS[bench.daq.family])
    except DaqError as error:
        do = "look at the index channel and at daq.index_counter"
        return Finding(check, "failed", str(error), do)
    turns = "revolution" if found.revolutions == 1 else "revolutions"
    saw = (
        f"{found.counts} from index to index over {found.revolutions} {turns} "
        f"(spread {found.spread}), the bench file says {expected}"
    )
    if abs(found.counts - expected) > _SPREAD_COUNTS:
        return Finding(check, "failed", saw, _mend_counts(found, bench))
    if found.spread > _SPREAD_COUNTS:
        do = "counts come and go: look at the encoder's cable, screen and supply"
        return Finding(check, "failed", saw, do)
    return Finding(check, "ok", saw)


def _mend_counts(found: CountsPerRev, bench: BenchSettings) -> str:
    """Say which setting would make the measured counts right."""
    lines = round(found.counts / (bench.counts_per_rev / bench.encoder.lines))
    return (
        f"if the code wheel has {lines} lines, set encoder.lines: {lines}; else counts are lost: "
        "look at the encoder's cable, screen and supply"
    )
