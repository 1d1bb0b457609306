from dataclasses import replace

import numpy as np
import pytest

from usmbench.errors import InterlockError, LostCountsError
from usmbench.settings.bench import InterlockSettings
from usmbench.sweep.interlocks import InterlockState, WindowSeen, watch

LIMITS = InterlockSettings()
# Ten windows of 10 ms at 9 rad/s and full phase: all is well.
WELL = WindowSeen(90.0, 41_000.0, 0.0, True, 9.0, 29, 29, 0.01)
STILL = replace(WELL, speed_rad_s=0.0, counts=0, edges=0)
OFF = replace(STILL, phase_deg=0.0, drive_on=False)


def run(windows: list[WindowSeen], limits: InterlockSettings = LIMITS) -> InterlockState:
    state = InterlockState()
    for seen in windows:
        state = watch(state, seen, limits)
    return state


def trip(windows: list[WindowSeen], limits: InterlockSettings = LIMITS) -> InterlockError:
    run(windows[:-1], limits)
    with pytest.raises(InterlockError) as caught:
        run(windows, limits)
    return caught.value


def test_a_motor_that_does_what_it_should_trips_nothing() -> None:
    run([OFF] * 20 + [WELL] * 1000 + [replace(STILL, phase_deg=5.0)] * 1000 + [OFF] * 100)


def test_over_speed_trips_at_the_second_window_in_either_direction() -> None:
    fast = replace(WELL, speed_rad_s=-16.1)
    error = trip([WELL, fast, fast])
    assert error.interlock == "overspeed_rad_s"
    assert "-16.10 rad/s" in str(error)
    assert "16" in str(error)


def test_one_false_count_is_no_over_speed() -> None:
    run([WELL, replace(WELL, speed_rad_s=40.0), WELL, replace(WELL, speed_rad_s=40.0), WELL])


def test_a_slipped_coupling_trips_after_half_a_second() -> None:
    error = trip([WELL] * 10 + [STILL] * 50)
    assert error.interlock == "no_motion_after_s"
    assert "coupling" in str(error)
    assert "0.50 s" in str(error)


def test_a_dead_channel_is_told_from_a_slipped_coupling() -> None:
    # One X4 channel alone counts one up and one down again.
    toggling = [replace(STILL, counts=(1, -1)[n % 2], edges=17) for n in range(50)]
    error = trip(toggling)
    assert error.interlock == "no_motion_after_s"
    assert "changed 850 times" in str(error)
    assert "channel" in str(error)


def test_slow_motion_is_motion() -> None:
    run([replace(STILL, counts=int(n % 10 == 0), edges=1) for n in range(1000)])


def test_standing_in_the_dead_zone_is_no_fault() -> None:
    run([replace(STILL, phase_deg=70.0, frequency_hz=42_000.0)] * 500)


def test_still_time_is_not_forgotten_in_the_dead_zone() -> None:
    standing = replace(STILL, phase_deg=0.0)
    assert trip(([STILL] * 20 + [standing] * 30) * 2 + [STILL] * 10).interlock == (
        "no_motion_after_s"
    )
    glides = [replace(STILL, phase_deg=float(90 * np.sin(n / 7.0))) for n in range(1000)]
    with pytest.raises(InterlockError, match="no motion"):
        run(glides)


def test_motion_in_the_dead_zone_is_motion() -> None:
    running_down = replace(STILL, phase_deg=0.0, counts=9, edges=9)
    run(([STILL] * 20 + [running_down]) * 20)


def test_still_time_does_not_add_up_over_motion() -> None:
    run(([STILL] * 49 + [WELL]) * 10)


def test_motion_without_drive_trips() -> None:
    moving = replace(OFF, speed_rad_s=0.6)
    error = trip([OFF, moving, moving])
    assert error.interlock == "motion_off_rad_s"
    assert "cut the amplifier's supply" in str(error)


def test_a_motor_may_run_down_after_the_drive_went_off() -> None:
    run([WELL, *[replace(OFF, speed_rad_s=5.0)] * 30])
    assert trip([WELL, *[replace(OFF, speed_rad_s=5.0)] * 32]).interlock == "motion_off_rad_s"


def test_hands_may_turn_the_shaft_while_the_load_is_set() -> None:
    run([replace(OFF, speed_rad_s=5.0, hands_off=False)] * 100)


def test_temperature_trips_where_there_is_a_sensor() -> None:
    error = trip([replace(WELL, temperature_c=69.9), replace(WELL, temperature_c=70.1)])
    assert error.interlock == "temperature_max_c"
    assert "70.1 °C" in str(error)


def test_drive_time_counts_from_the_last_pause() -> None:
    limits = replace(LIMITS, drive_time_max_s=0.995)
    run(([WELL] * 99 + [OFF]) * 3, limits)
    assert trip([WELL] * 100, limits).interlock == "drive_time_max_s"


def test_lost_counts() -> None:
    run([replace(WELL, index_error_counts=error) for error in (0, 1, -1, None)])
    with pytest.raises(LostCountsError, match="-2 counts off"):
        run([replace(WELL, index_error_counts=-2)])
    run([replace(WELL, index_error_counts=-50)], replace(LIMITS, index_error_max_counts=None))


def test_a_dead_channel_that_the_index_shows() -> None:
    toggling = replace(STILL, phase_deg=45.0, counts=1, edges=33, index_error_counts=-300)
    with pytest.raises(LostCountsError, match="one encoder channel is dead"):
        run([toggling])


def test_a_dead_direction_that_the_index_shows() -> None:
    upward = replace(WELL, phase_deg=-90.0, index_error_counts=-1175)
    assert upward.speed_rad_s > 0.0
    with pytest.raises(LostCountsError, match="against φ = -90°: one encoder channel is dead"):
        run([upward])


def test_a_motor_that_moved_at_this_phase_must_go_on_moving() -> None:
    slow = replace(WELL, phase_deg=30.0, counts=7, edges=7)
    error = trip([slow] * 10 + [replace(STILL, phase_deg=40.0)] * 50)
    assert error.interlock == "no_motion_after_s"
