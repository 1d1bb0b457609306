from dataclasses import replace

import pytest

from usmbench.errors import InputError
from usmbench.settings.bench import BenchSettings, GeneratorSettings, InterlockSettings
from usmbench.settings.plan import Plan
from usmbench.settings.plan_file import load_plan, parse_plan, shipped_plans
from usmbench.settings.yaml_source import parse_source
from usmbench.sweep.preflight import NOMINAL_BOARD, check_plan, interlocks_of

BENCH = BenchSettings()
NARROW = replace(
    BENCH,
    generator=GeneratorSettings(
        frequency_limits_hz=(40_500, 41_500), phase_limits_deg=(-90.0, 90.0)
    ),
)


def plan_of(text: str, frequency_hz: str = "41000") -> Plan:
    head = f"format: usmbench-plan/1\nfrequency_hz: {frequency_hz}\n"
    return parse_plan(parse_source(head + text, "plan.yaml"))


@pytest.mark.parametrize("name", shipped_plans())
def test_the_plans_that_ship_may_be_driven(name: str) -> None:
    check_plan(load_plan(name), BENCH)


PASS = "passes: [{phase_deg: [0, 90]}]\n"


@pytest.mark.parametrize(
    ("plan", "line", "words"),
    [
        (plan_of(PASS, "[41000, 42000]"), 2, "frequency_hz[1]"),
        (plan_of("passes:\n  - phase_deg: [0, 91]\n"), 4, "passes[0].phase_deg[1]"),
        (plan_of("passes: [{phase_deg: {from: -95, to: 0, step: 5}}]\n"), 3, "phase_deg.from"),
        (plan_of(PASS + "warm_up: {phase_deg: 120, duration_s: 1}\n"), 4, "warm_up.phase_deg"),
        (
            plan_of(PASS + "warm_up: {phase_deg: 9, duration_s: 1, frequency_hz: 42000}\n"),
            4,
            "warm_up.frequency_hz",
        ),
        (
            plan_of(
                "excitation: {kind: telegraph, amplitude_deg: 80, centre_deg: 20, duration_s: 9}\n"
            ),
            3,
            "excitation.amplitude_deg",
        ),
    ],
)
def test_beyond_the_lab_is_refused_with_its_line(plan: Plan, line: int, words: str) -> None:
    check_plan(plan, BENCH)
    with pytest.raises(InputError, match="this lab's") as caught:
        check_plan(plan, NARROW)
    assert caught.value.line == line
    assert words in str(caught.value)


def test_beyond_the_board_is_refused_too() -> None:
    wide = replace(BENCH, generator=GeneratorSettings(frequency_limits_hz=(1.0, 1e6)))
    with pytest.raises(InputError, match=r"plan.yaml:2: frequency_hz: .* board"):
        check_plan(plan_of(PASS, "43000"), wide)
    small = replace(NOMINAL_BOARD, phase_word_max=512)
    with pytest.raises(InputError, match="board"):
        check_plan(plan_of(PASS), BENCH, small)


def test_a_hold_too_short_to_follow() -> None:
    hold = "excitation: {kind: telegraph, amplitude_deg: 80, duration_s: 9, hold_windows: 2}\n"
    with pytest.raises(InputError, match=r"hold_windows.*at least 3"):
        check_plan(plan_of(hold), BENCH)


def test_a_band_too_high_for_the_hold() -> None:
    band = "excitation: {kind: multisine, amplitude_deg: 80, duration_s: 9, band_hz: [1, 20]}\n"
    with pytest.raises(InputError, match="choose at most 10"):
        check_plan(plan_of(band), BENCH)


def test_a_plan_that_drives_too_long() -> None:
    long = plan_of("passes: [{phase_deg: [0, 90], repeats: 4000}]\n")
    with pytest.raises(InputError, match="4000 s without a break"):
        check_plan(long, BENCH)
    pauses = plan_of(
        "passes: [{phase_deg: [0, 90], repeats: 2000}]\ntorque_nm: [0, 0.1]\nload: operator\n"
    )
    check_plan(pauses, BENCH)


def test_a_plan_tightens_the_limits_and_never_widens_them() -> None:
    plan = plan_of(PASS + "limits: {overspeed_rad_s: 5, temperature_max_c: 90}\n")
    assert interlocks_of(plan, BENCH) == InterlockSettings(overspeed_rad_s=5)
