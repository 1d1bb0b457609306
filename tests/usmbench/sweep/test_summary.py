from dataclasses import replace

import pytest

from usmbench.settings.bench import BenchSettings
from usmbench.settings.plan_file import load_plan, parse_plan
from usmbench.settings.yaml_source import Source
from usmbench.sweep.summary import PASSES_SHOWN, describe, longest_drive_s, n_windows

BENCH = BenchSettings()


def described(name: str) -> str:
    return "\n".join(describe(load_plan(name), BENCH, BENCH.interlocks))


def test_a_dry_run_shows_passes_limits_and_duration() -> None:
    text = described("phase-sweep")
    assert "φ -90° … 90°  43 phases" in text
    assert "φ 90° … -90°  43 phases" in text
    assert "86 of 50 windows of 10 ms" in text
    assert "limits 40000 … 42000 Hz" in text
    # Two passes of 43 half seconds, 2 s of warm-up, 0.05 s before and 0.33 s after.
    assert "duration   45.4 s, 174.4 s where no dwell settles" in text


def test_a_dry_run_of_an_excitation() -> None:
    text = described("telegraph")
    assert "telegraph -90° … 90°  1200 holds" in text
    assert "settles" not in text


def test_many_passes_are_counted_not_listed() -> None:
    passes = [{"phase_deg": [0, 10], "repeats": 100}]
    document = {"format": "usmbench-plan/1", "frequency_hz": 41000, "passes": passes}
    plan = parse_plan(Source("plan.yaml", document))
    lines = list(describe(plan, BENCH, BENCH.interlocks))
    assert sum(line.startswith("pass ") for line in lines) == PASSES_SHOWN
    assert f"and {100 - PASSES_SHOWN} more" in "\n".join(lines)


def test_what_would_take_hours_to_run_through_is_counted_at_once() -> None:
    passes = [{"phase_deg": {"from": -180, "to": 180, "step": 0.01}, "repeats": 1_000_000}]
    passes.append({"phase_deg": [0, 10], "direction": "both", "repeats": 2})
    document = {
        "format": "usmbench-plan/1",
        "frequency_hz": [40_500, 41_000],
        "torque_nm": [0, 0.1],
        "load": "operator",
        "passes": passes,
    }
    plan = parse_plan(Source("plan.yaml", document))
    lines = list(describe(plan, BENCH, BENCH.interlocks))
    assert f"           and {2 * 2 * (1_000_000 + 2 * 2) - PASSES_SHOWN} more" in lines


@pytest.mark.parametrize("n_torques", [1, 3, PASSES_SHOWN, PASSES_SHOWN + 2])
@pytest.mark.parametrize("name", ["phase-sweep", "telegraph"])
def test_the_passes_that_are_not_shown_are_counted(name: str, n_torques: int) -> None:
    plan = replace(load_plan(name), torque_nm=tuple(0.01 * k for k in range(n_torques)))
    lines = list(describe(plan, BENCH, BENCH.interlocks))
    shown = sum(line.startswith("pass ") for line in lines)
    further = sum(int(line.split()[1]) for line in lines if line.endswith(" more"))
    assert shown + further == n_torques * (2 if plan.passes else 1)


def test_the_drive_pauses_where_the_load_is_changed() -> None:
    plan = load_plan("operating-points")
    assert longest_drive_s(plan, 0.01) == 3 * 74 * 0.5 + 5
    assert n_windows(plan, BENCH.interlocks, 0.01) == 9 * 74 * 50 + 500 + 5 + 33
