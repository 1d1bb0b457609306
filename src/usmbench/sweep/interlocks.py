"""When the drive must go off: pure checks, one window after another."""

from dataclasses import dataclass, replace
from math import inf

from usmbench.errors import InterlockError, LostCountsError
from usmbench.settings.bench import InterlockSettings
from usmbench.sweep.proven_motion import NOTHING_PROVEN, ProvenMotion, must_move, prove

# One window may hold a false count; two in a row are motion.
WINDOWS_TO_TRIP = 2
# A dead encoder channel lets an X4 counter toggle by one; a moving motor passes this at once.
STILL_COUNTS = 2
DEAD_CHANNEL = "one encoder channel is dead; look at the wires of channels A and B"


@dataclass(frozen=True, slots=True)
class WindowSeen:
    """What one window showed.

    Parameters
    ----------
    phase_deg, frequency_hz, torque_nm
        The drive and the load in force.
    drive_on
        Whether the outputs are on.
    speed_rad_s
        Speed from the counts alone.
    counts
        Counts of the window.
    edges
        Changes of the counter within the window, in either direction; may be 0 where the window
        has counts, or nothing that an interlock asks about.
    window_s
        Duration of the window.
    temperature_c
        Temperature, or None without a sensor.
    index_error_counts
        Counts by which the index pulse was off, or None where none passed.
    hands_off
        Whether nobody may be turning the shaft by hand just now.
    """

    phase_deg: float
    frequency_hz: float
    torque_nm: float
    drive_on: bool
    speed_rad_s: float
    counts: int
    edges: int
    window_s: float
    temperature_c: float | None = None
    index_error_counts: int | None = None
    hands_off: bool = True


@dataclass(frozen=True, slots=True)
class InterlockState:
    """What the windows before have shown; a new one starts a run.

    Parameters
    ----------
    fast_windows
        Windows in a row above the over-speed limit.
    still_s
        Time without motion though driven where it has to move; through the dead zone it stays.
    still_counts
        Counts since the last motion.
    still_edges
        Changes of the counter in that time without motion.
    driven_s
        Time since the drive went on.
    off_s
        Time since the drive went off.
    moving_off_windows
        Windows in a row with motion though the drive is off.
    proven
        Where motion was seen.
    """

    fast_windows: int = 0
    still_s: float = 0.0
    still_counts: int = 0
    still_edges: int = 0
    driven_s: float = 0.0
    off_s: float = inf
    moving_off_windows: int = 0
    proven: ProvenMotion = NOTHING_PROVEN


def watch(state: InterlockState, seen: WindowSeen, settings: InterlockSettings) -> InterlockState:
    """Hold one window against every interlock.

    Parameters
    ----------
    state
        What the windows before left.
    seen
        The window.
    settings
        The limits.

    Returns
    -------
    InterlockState
        To be handed in with the next window.

    Raises
    ------
    usmbench.errors.InterlockError
        An interlock tripped: the drive must go off.
    usmbench.errors.LostCountsError
        The index pulse shows that counts were lost.
    """
    _check_temperature(seen, settings)
    _check_index(seen, settings)
    fast_windows = _fast_windows(state, seen, settings)
    if not seen.drive_on:
        off_s = state.off_s + seen.window_s
        moving = _moving_off_windows(state, seen, settings)
        return InterlockState(
            fast_windows, off_s=off_s, moving_off_windows=moving, proven=state.proven
        )
    driven_s = state.driven_s + seen.window_s
    if driven_s > settings.drive_time_max_s:
        raise InterlockError(
            f"driven for {driven_s:.0f} s without a break (limit drive_time_max_s "
            f"{settings.drive_time_max_s:g} s); let the motor cool and take the plan up again",
            interlock="drive_time_max_s",
        )
    point, moving = (seen.frequency_hz, seen.torque_nm), abs(seen.counts) > STILL_COUNTS
    proven = prove(state.proven, point, seen.phase_deg, moving)
    running = InterlockState(fast_windows, driven_s=driven_s, off_s=0.0, proven=proven)
    still_counts = state.still_counts + seen.counts
    if abs(still_counts) > STILL_COUNTS:
        return running
    # A plan that goes through the dead zone every so often must not forget what it saw before.
    still_s, still_edges = state.still_s, state.still_edges
    if must_move(proven, seen.phase_deg, settings):
        still_s, still_edges = still_s + seen.window_s, still_edges + seen.edges
        if still_s >= settings.no_motion_after_s:
            raise _no_motion(still_s, still_edges, seen, settings)
    return replace(running, still_s=still_s, still_counts=still_counts, still_edges=still_edges)


def _fast_windows(state: InterlockState, seen: WindowSeen, settings: InterlockSettings) -> int:
    if abs(seen.speed_rad_s) <= settings.overspeed_rad_s:
        return 0
    if state.fast_windows + 1 >= WINDOWS_TO_TRIP:
        raise InterlockError(
            f"over-speed: {seen.speed_rad_s:.2f} rad/s at φ = {seen.phase_deg:g}° and "
            f"{seen.frequency_hz:g} Hz (limit overspeed_rad_s {settings.overspeed_rad_s:g}); look "
            "at the load, the drive voltage and the encoder's lines in the bench file",
            interlock="overspeed_rad_s",
        )
    return state.fast_windows + 1


def _moving_off_windows(
    state: InterlockState, seen: WindowSeen, settings: InterlockSettings
) -> int:
    still = abs(seen.speed_rad_s) <= settings.motion_off_rad_s
    if still or not seen.hands_off or state.off_s < settings.motion_off_after_s:
        return 0
    if state.moving_off_windows + 1 >= WINDOWS_TO_TRIP:
        raise InterlockError(
            f"motion though the drive is off: {seen.speed_rad_s:.2f} rad/s (limit "
            f"motion_off_rad_s {settings.motion_off_rad_s:g}); cut the amplifier's supply, then "
            "look at its inputs and at what else may turn the shaft",
            interlock="motion_off_rad_s",
        )
    return state.moving_off_windows + 1


def _no_motion(
    still_s: float, edges: int, seen: WindowSeen, settings: InterlockSettings
) -> InterlockError:
    driven = (
        f"driven for {still_s:.2f} s where the motor has to move, last at φ = {seen.phase_deg:g}° "
        f"and {seen.frequency_hz:g} Hz"
    )
    limit = f"(limit no_motion_after_s {settings.no_motion_after_s:g} s)"
    if _goes_nowhere(0, edges):
        message = (
            f"no motion: {driven} {limit}, the counter changed {edges} times but went nowhere: "
            f"{DEAD_CHANNEL}"
        )
    else:
        message = (
            f"no motion: {driven} {limit} without encoder counts; look at the coupling between "
            "motor and encoder (slipped?), the encoder's cable and the amplifier's supply"
        )
    return InterlockError(message, interlock="no_motion_after_s")


def _check_temperature(seen: WindowSeen, settings: InterlockSettings) -> None:
    if seen.temperature_c is not None and seen.temperature_c > settings.temperature_max_c:
        raise InterlockError(
            f"too hot: {seen.temperature_c:.1f} °C (limit temperature_max_c "
            f"{settings.temperature_max_c:g}); let the motor cool and take the plan up again",
            interlock="temperature_max_c",
        )


def _check_index(seen: WindowSeen, settings: InterlockSettings) -> None:
    limit, error = settings.index_error_max_counts, seen.index_error_counts
    if limit is None or error is None or abs(error) <= limit:
        return
    if _goes_nowhere(seen.counts, seen.edges):
        why = f"the counter changed {seen.edges} times but went nowhere: {DEAD_CHANNEL}"
    elif seen.phase_deg * seen.speed_rad_s < 0.0:
        why = f"counted against φ = {seen.phase_deg:g}°: {DEAD_CHANNEL}"
    else:
        why = (
            "counts are lost, or their direction is; look at the encoder's cable and its lines in "
            "the bench file"
        )
    raise LostCountsError(
        f"the index pulse came {error:+d} counts off at {seen.speed_rad_s:.2f} rad/s (limit "
        f"index_error_max_counts {limit}): {why}; to record all the same, set the limit to null "
        "in the bench file"
    )


def _goes_nowhere(counts: int, edges: int) -> bool:
    """Return whether the counter toggles, as an X4 counter does on one channel alone."""
    return abs(counts) <= STILL_COUNTS < edges
