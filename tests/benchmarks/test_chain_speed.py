from dataclasses import replace
from pathlib import Path

from benchmarks.chain_speed import in_process, lock_step, motor_alone, same_rows
from usmbench.settings.plan import Plan
from usmbench.settings.plan_file import load_plan


def short_plan() -> Plan:
    plan = load_plan("phase-sweep")
    few = replace(plan.passes[0], phase_deg=(-90.0, -20.0, 0.0, 5.0, 60.0))
    return replace(plan, passes=(few,), warm_up=None)


def test_a_seed_gives_the_same_rows_in_process_and_over_the_wire(tmp_path: Path) -> None:
    near, far = tmp_path / "near", tmp_path / "far"
    assert in_process(short_plan(), near) > 1.0
    assert lock_step(short_plan(), far) > 0.2
    assert same_rows(near, far)
    assert len((near / "windows.csv").read_bytes()) > 10_000


def test_rows_that_differ_are_noticed(tmp_path: Path) -> None:
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "windows.csv").write_text(name)
    assert not same_rows(tmp_path / "one", tmp_path / "other")


def test_the_motor_runs_faster_than_real_time() -> None:
    assert motor_alone(50) > 5.0
