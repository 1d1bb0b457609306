import signal
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from usmbench.errors import BenchError, InterlockError, LostCountsError, PortError
from usmbench.instruments.samples import SampleBlock
from usmbench.settings.bench import BenchSettings, InterlockSettings
from usmbench.settings.plan import Plan
from usmbench.settings.plan_file import parse_plan
from usmbench.settings.yaml_source import Source
from usmbench.sweep.controller import SweepController
from usmbench.sweep.schedule import schedule
from usmbench.sweep.summary import WINDOWS_BEFORE, n_windows, windows_after
from usmbench.sweep.window_reader import FROM_ZERO, Start

WINDOW_S = 0.01
LIMITS = InterlockSettings()
AFTER = windows_after(LIMITS, WINDOW_S)


def plan_of(**keys: object) -> Plan:
    return parse_plan(
        Source(
            "plan.yaml",
            {
                "format": "usmbench-plan/1",
                "frequency_hz": 41000,
                "dwell": {"windows": 20, "settle": {"min_windows": 2, "over_windows": 4}},
                "passes": [{"phase_deg": [-90, 0, 90], "direction": "both"}],
                **keys,
            },
        )
    )


def sweep(
    fake: Any,
    bench_settings: BenchSettings,
    plan: Plan,
    *,
    limits: InterlockSettings = LIMITS,
    observer: Any = None,
    start: Start = FROM_ZERO,
) -> None:
    controller = SweepController(
        fake.instruments,
        bench_settings,
        limits,
        fake,
        observer=observer,
        ask_operator=plan.ask_operator,
        start=start,
    )
    controller.run(schedule(plan, WINDOW_S), n_windows(plan, limits, WINDOW_S))


def test_a_plan_gives_its_windows_and_pairs_and_leaves_the_drive_off(
    fake: Any, bench_settings: BenchSettings
) -> None:
    sweep(fake, bench_settings, plan_of())
    assert len(fake.windows) == WINDOWS_BEFORE + 6 * 20 + AFTER
    assert [pair.phase_deg for pair in fake.pairs] == [-90, 0, 90, 90, 0, -90]
    assert [pair.direction for pair in fake.pairs] == [1, 1, 1, -1, -1, -1]
    assert [pair.dwell for pair in fake.pairs] == list(range(6))
    assert all(pair.settled == 1 and pair.n_windows == 14 for pair in fake.pairs)
    assert [pair.speed_rad_s for pair in fake.pairs] == pytest.approx(
        [-10, 0, 10, 10, 0, -10], abs=0.02
    )
    assert not fake.on
    assert "off" in fake.calls[-1]


def test_rows_say_what_was_in_force_when(fake: Any, bench_settings: BenchSettings) -> None:
    sweep(fake, bench_settings, plan_of())
    t_s = np.array([row.t_s for row in fake.windows])
    np.testing.assert_allclose(np.diff(t_s), WINDOW_S)
    assert t_s[0] == pytest.approx(WINDOW_S)
    driven = [row for row in fake.windows if row.drive_on]
    assert len(driven) == 120
    for row in driven[1:]:
        expected = 10 * np.sin(np.radians(row.phase_deg))
        assert row.speed_rad_s == pytest.approx(expected, abs=0.32)
    assert {row.phase_deg for row in fake.windows if not row.drive_on} == {0.0}
    counted = sum(row.settled for row in fake.windows)
    assert counted == sum(pair.n_windows for pair in fake.pairs)


def test_windows_read_late_belong_to_the_old_phase_and_to_no_dwell(
    make_fake: Any, bench_settings: BenchSettings
) -> None:
    fake = make_fake(ahead_samples=2500)
    sweep(fake, bench_settings, plan_of())
    # Two windows and a half were on their way at each of the six commands.
    assert len(fake.windows) == WINDOWS_BEFORE + 6 * (20 + 2) + AFTER
    phases = [row.phase_deg for row in fake.windows]
    first = phases.index(-90.0)
    assert phases[first : first + 22] == [-90.0] * 22
    assert all(pair.n_windows == 14 for pair in fake.pairs)


def test_a_dwell_that_settles_late_is_extended(
    make_fake: Any, bench_settings: BenchSettings
) -> None:
    fake = make_fake()
    begun = WINDOWS_BEFORE * 1000
    fake.speed_at = lambda phase, on: 0.2 * min((fake.taken_samples - begun) / 1000, 21) * on
    dwell = {"windows": 20, "extend_to_windows": 60, "settle": {"over_windows": 6}}
    sweep(fake, bench_settings, plan_of(dwell=dwell, passes=[{"phase_deg": [80]}]))
    # It rises up to window 22; window 26 is the last of six whose halves differ by 0.067 rad/s.
    (pair,) = fake.pairs
    assert (pair.settled, pair.n_windows) == (1, 6)
    assert [row.settled for row in fake.windows if row.drive_on] == [0] * 26 + [1] * 6


def test_a_dwell_that_never_settles_ends_all_the_same(
    make_fake: Any, bench_settings: BenchSettings
) -> None:
    fake = make_fake()
    fake.speed_at = lambda phase, on: 0.1 * (fake.taken_samples / 1000) * on
    dwell = {"windows": 20, "extend_to_windows": 33, "settle": {"over_windows": 4}}
    sweep(fake, bench_settings, plan_of(dwell=dwell, passes=[{"phase_deg": [80]}]))
    (pair,) = fake.pairs
    assert (pair.settled, pair.n_windows) == (0, 4)
    assert sum(row.drive_on for row in fake.windows) == 33
    assert not any(row.settled for row in fake.windows)


def test_signs_of_life_go_out_all_through_a_long_dwell(
    fake: Any, bench_settings: BenchSettings
) -> None:
    dwell = {"windows": 300}
    sweep(fake, bench_settings, plan_of(dwell=dwell, passes=[{"phase_deg": [90]}]))
    gaps = np.diff(fake.contact_samples)
    assert np.max(gaps) == 25_000
    assert fake.calls.count("heartbeat") >= 12


def test_no_command_waits_for_a_sign_of_life(fake: Any, bench_settings: BenchSettings) -> None:
    plan = plan_of(dwell={"windows": 25}, passes=[{"phase_deg": [30, 60, 90]}])
    sweep(fake, bench_settings, plan)
    commands = [i for i, call in enumerate(fake.calls) if call in ("phase 60", "phase 90")]
    assert len(commands) == 2
    assert all("heartbeat" not in fake.calls[i - 3 : i] for i in commands)


def test_a_loop_that_hangs_sends_no_sign_of_life(fake: Any, bench_settings: BenchSettings) -> None:
    sweep(fake, bench_settings, plan_of())
    heartbeats = [i for i, call in enumerate(fake.calls) if call == "heartbeat"]
    assert heartbeats
    assert all(fake.calls[i - 1] == "window" for i in heartbeats)


def test_the_warm_up_gives_windows_and_no_pair(fake: Any, bench_settings: BenchSettings) -> None:
    plan = plan_of(warm_up={"phase_deg": 45, "duration_s": 0.5}, passes=[{"phase_deg": [90]}])
    sweep(fake, bench_settings, plan)
    warm = [row for row in fake.windows if row.phase_deg == 45]
    assert len(warm) == 50
    assert {(row.sweep, row.settled) for row in warm} == {(-1, 0)}
    assert len(fake.pairs) == 1


def test_the_operator_sets_each_load_with_the_drive_off(
    make_fake: Any, bench_settings: BenchSettings
) -> None:
    fake = make_fake(load_after_windows=70)
    plan = plan_of(torque_nm=[0, 0.1], load="operator", passes=[{"phase_deg": [90]}])
    sweep(fake, bench_settings, plan, observer=fake)
    assert fake.loads == [(0.0, True), (0.1, True)]
    # One more each, so that who watches knows before the question is asked.
    waiting = WINDOWS_BEFORE + 2 * 71 + AFTER
    assert sum(fake.waiting) == 2 * 71
    assert sum(not row.drive_on for row in fake.windows) == waiting
    assert [pair.torque_nm for pair in fake.pairs] == [0.0, 0.1]
    assert np.max(np.diff(fake.contact_samples)) <= 26_000


@pytest.mark.parametrize(("closed", "error"), [(True, KeyboardInterrupt), (False, BenchError)])
def test_a_terminal_that_is_closed_stops_the_run_as_the_user_does(
    fake: Any,
    bench_settings: BenchSettings,
    monkeypatch: pytest.MonkeyPatch,
    closed: bool,
    error: type[BaseException],
) -> None:
    next_block = fake.next_block

    def after_the_end() -> SampleBlock:
        if closed:
            signal.raise_signal(signal.SIGTERM)  # SIGHUP in life, which Windows has not
        block: SampleBlock = next_block()
        return block

    def ended() -> bool:
        monkeypatch.setattr(fake, "next_block", after_the_end)
        raise BenchError("standard input has ended")

    monkeypatch.setattr(fake, "load_is_set", ended)
    with pytest.raises(error):
        sweep(fake, bench_settings, plan_of(load="operator"))
    assert not fake.on


def test_a_constant_load_is_told_but_not_asked_for(
    fake: Any, bench_settings: BenchSettings
) -> None:
    sweep(fake, bench_settings, plan_of(torque_nm=0.2))
    assert fake.loads == [(0.2, False)]
    assert {row.torque_nm for row in fake.windows if row.drive_on} == {0.2}


def test_windows_left_run_down_to_none(fake: Any, bench_settings: BenchSettings) -> None:
    sweep(fake, bench_settings, plan_of(), observer=fake)
    assert fake.seen_pairs == fake.pairs
    assert fake.left[0] >= len(fake.windows) - WINDOWS_BEFORE
    dwelling = fake.left[WINDOWS_BEFORE : -AFTER or None]
    assert dwelling == sorted(dwelling, reverse=True)


def test_a_resumed_run_goes_on_in_time_and_angle(fake: Any, bench_settings: BenchSettings) -> None:
    sweep(fake, bench_settings, plan_of(), start=Start(100.0, 7.0))
    assert fake.windows[0].t_s == pytest.approx(100.01)
    assert fake.windows[0].angle_rad == pytest.approx(7.0)


def fails(
    fake: Any,
    bench_settings: BenchSettings,
    kind: type[Exception],
    words: str,
    limits: InterlockSettings = LIMITS,
    **keys: object,
) -> int:
    with pytest.raises(kind, match=words):
        sweep(fake, bench_settings, plan_of(**keys), limits=limits)
    assert not fake.on
    driven = [i for i, call in enumerate(fake.calls) if call == "on"]
    assert fake.calls[-1] == "off"
    return len(driven)


def test_interlocks_stop_the_drive_before_anything_else(
    make_fake: Any, bench_settings: BenchSettings
) -> None:
    slow = replace(LIMITS, overspeed_rad_s=9.0)
    assert fails(make_fake(), bench_settings, InterlockError, "over-speed", slow)
    slipped = make_fake(speed_at=lambda phase, on: 0.0)
    long = {"windows": 100}
    fails(slipped, bench_settings, InterlockError, "coupling", dwell=long)
    dead = make_fake(fake_counts=lambda sample: (sample // 60) % 2)
    fails(dead, bench_settings, InterlockError, "one encoder channel is dead", dwell=long)
    fails(make_fake(temperature_c=80.0), bench_settings, InterlockError, "too hot")


def test_motion_before_the_first_command_means_no_command(
    make_fake: Any, bench_settings: BenchSettings
) -> None:
    fake = make_fake(speed_at=lambda phase, on: 3.0)
    assert fails(fake, bench_settings, InterlockError, "though the drive is off") == 0


def test_an_output_that_stays_on_is_found_after_the_last_dwell(
    make_fake: Any, bench_settings: BenchSettings
) -> None:
    fake = make_fake()
    fake.speed_at = lambda phase, on: 5.0 * fake.was_on
    assert fails(fake, bench_settings, InterlockError, "though the drive is off") == 1
    assert len(fake.pairs) == 6


def test_lost_counts_stop_the_run(make_fake: Any, bench_settings: BenchSettings) -> None:
    fake = make_fake()
    turns = {"windows": 200}
    block = fake.next_block

    def with_index() -> SampleBlock:
        made: SampleBlock = block()
        positions = made.counts.astype(np.int32).astype(np.int64)
        # An index that comes 40 counts early each turn: so many were lost.
        return replace(made, index_counts=np.abs(positions) // 1960)

    fake.next_block = with_index
    fails(fake, bench_settings, LostCountsError, "40 counts off", dwell=turns)


@pytest.mark.parametrize("call", ["start", "next_block", "raw", "window", "pair", "phase 0"])
def test_whatever_fails_the_drive_goes_off_first(
    make_fake: Any, bench_settings: BenchSettings, call: str
) -> None:
    fake = make_fake()

    def fail(name: str) -> None:
        if name == call and (call == "start" or fake.was_on):
            raise PortError("gone")

    fake.hook = fail
    with pytest.raises(PortError, match="gone"):
        sweep(fake, bench_settings, plan_of())
    assert fake.calls.index("off", fake.calls.index(call)) == len(fake.calls) - 1


def test_a_drive_that_cannot_be_switched_off_does_not_hide_the_reason(
    make_fake: Any, bench_settings: BenchSettings
) -> None:
    fake = make_fake()

    def fail(name: str) -> None:
        if name == "off":
            raise BenchError("no answer")
        if name == "pair":
            raise PortError("gone")

    fake.hook = fail
    with pytest.raises(PortError, match="gone") as caught:
        sweep(fake, bench_settings, plan_of())
    assert "no answer" in caught.value.__notes__[0]


def test_a_run_that_ends_well_tells_that_the_drive_cannot_be_switched_off(
    make_fake: Any, bench_settings: BenchSettings
) -> None:
    fake = make_fake()

    def fail(name: str) -> None:
        if name == "off":
            raise BenchError("no answer")

    fake.hook = fail
    with pytest.raises(BenchError, match="no answer"):
        sweep(fake, bench_settings, plan_of())
