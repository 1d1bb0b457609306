"""A small naming campaign, one draw of it through the serial port and the DAQ client."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.campaign_bench import MotorBench
from benchmarks.campaign_draws import GROUPS, Choice, Draw, Hidden, draws, hide, motor_of
from benchmarks.campaign_outcome import Outcome
from benchmarks.campaign_runs import COUNT_RAD, COUNT_RAD_S, Excited, Measured, Motor, TurnedDisc
from benchmarks.campaign_sizes import noise_of, square_of, strength_of, well_counted
from benchmarks.campaign_tables import report, share, wrong_ones
from hil_sim.defects import CATALOGUE
from usmbench.runs.reader import read_run
from usmbench.sweep.schedule import schedule

SHORT = Excited("staircase", 10.0, 5)


def test_a_dead_channel_is_named_through_the_wire(motor_bench: MotorBench) -> None:
    hidden = Hidden("single", ("dead_direction=1",), ("unsigned_counts",), 1.0)
    outcome = motor_bench.diagnosed(Draw(1, hidden, SHORT, wire=True))
    assert outcome.error == ""
    assert outcome.judgement == "right"
    assert outcome.strength > 10.0


def test_a_late_amplifier_is_another_angle_at_another_frequency() -> None:
    hidden = Hidden("single", ("amplifier_delay=40.0",), ("phase_offset",), 10.0)
    assert hidden.truth([41_000.0]) == pytest.approx({"offset_deg": -0.5904})
    assert hidden.truth([40_000.0]) == pytest.approx({"offset_deg": -0.576})
    assert hidden.truth([40_000.0, 41_000.0]) == {}  # two angles, none of them the true one


def test_the_size_of_an_effect_is_what_no_wander_explains_and_no_handful_of_windows() -> None:
    speed, other = 5.0 * np.random.default_rng(2).standard_normal((2, 4000))
    steady, wander = np.zeros((4000, 1)), 0.01 * speed[:, None]

    def strength(effect: NDArray[np.float64], wanders: NDArray[np.float64]) -> float:
        return strength_of(np.stack([effect, effect]), wanders, 0.05)

    assert strength(0.01 * other, steady) == pytest.approx(1.0, rel=0.1)
    assert strength(0.01 * other, wander) == pytest.approx(1.0, rel=0.1)
    assert strength(0.01 * speed, steady) == pytest.approx(1.0, rel=0.1)
    assert strength(0.01 * speed, wander) == pytest.approx(4000**-0.5, rel=0.1)
    assert strength(np.r_[np.full(8, 100.0), np.zeros(3992)], steady) == 0.0


def test_a_count_falls_into_a_window_for_sure_where_the_shaft_stands_on_or_turns_on() -> None:
    speed = COUNT_RAD_S * np.array([0.0, 0.0, 0.5, 3.0, 3.0, -3.0, 1.9, 0.0, 0.0])
    well = [True, True, False, False, True, True, False, False, True]
    assert well_counted(speed[None]).tolist() == well
    creeps = np.r_[speed[:-1], COUNT_RAD_S]
    assert well_counted(np.stack([speed, creeps])).tolist() == [*well[:-1], False]


def test_a_disc_that_is_turned_reads_so_much_further_at_every_angle() -> None:
    angle_rad = np.linspace(-3.0, 3.0, 7)
    assert TurnedDisc(0.25).disc_error()(angle_rad) == pytest.approx(0.25 * COUNT_RAD)
    assert pytest.approx(np.radians(0.18)) == COUNT_RAD  # 500 lines, four counts each


def test_what_another_day_does_not_show_counts_only_where_chance_is_the_cause() -> None:
    rng = np.random.default_rng(3)
    effect, counts = rng.standard_normal(5000), rng.standard_normal((3, 5000))
    seen = 0.3 * effect + counts
    assert square_of(seen) / 5000 == pytest.approx(0.09, abs=0.03)
    assert square_of(seen, by_chance=True) / 5000 == pytest.approx(1.09, rel=0.05)


def test_the_noise_of_three_days_is_that_of_one_and_leaves_the_gain_out() -> None:
    rng = np.random.default_rng(4)
    speed, noise = 5.0 * rng.standard_normal(3000), 0.02 * rng.standard_normal((3, 3000))
    days = np.outer([0.99, 1.0, 1.02], speed) + noise
    assert np.std(noise_of(days)) == pytest.approx(0.02, rel=0.05)


def test_the_wire_gives_the_rows_of_the_process(tmp_path: Path) -> None:
    quick = replace(SHORT, kind="telegraph", duration_s=2.0)
    runs = [Measured(Motor(4), quick, 3, wire=wire).folder(tmp_path) for wire in (False, True)]
    in_process, wired = (read_run(run).speed_rad_s for run in runs)
    assert np.array_equal(in_process, wired)


def test_draws_repeat_and_go_through_every_mechanism() -> None:
    first = [d for motor in range(10) for d in draws(3, motor, len(GROUPS), 1, Choice())]
    again = [d for motor in range(10) for d in draws(3, motor, len(GROUPS), 1, Choice())]
    assert first == again
    drawn = {d.mechanism for draw in first for d in draw.hidden.made}
    assert drawn == set(CATALOGUE)
    assert sum(draw.wire for draw in first) == 10
    assert {draw.hidden.group for draw in first} == {"single", "outside", "two", "nothing"}
    two = [len(draw.excited.frequencies_hz) == 2 for draw in first]
    assert 0.3 < np.mean(two) < 0.7


def test_only_what_is_asked_for_is_hidden() -> None:
    choice = Choice((3.0,), ("weak_generator", "nothing"), two_frequencies=1.0)
    drawn = list(draws(3, 1, 4, 0, choice))
    assert [draw.hidden.causes for draw in drawn] == [("generator_imbalance",), ()] * 2
    assert {len(draw.excited.frequencies_hz) for draw in drawn} == {2}


def test_a_run_at_two_frequencies_takes_no_longer_and_has_a_name_of_its_own() -> None:
    for kind in ("staircase", "telegraph"):
        one, two = (Excited(kind, 12.0, 1, f) for f in ((41_000.0,), (40_050.0, 41_000.0)))
        seconds = [sum(dwell.windows for dwell in schedule(e.plan(), 0.01)) for e in (one, two)]
        assert seconds[1] == pytest.approx(seconds[0], rel=0.05)
        assert one.name != two.name


def test_motors_wander_in_turn() -> None:
    assert [motor_of(1, k, (0.0, 0.01)).wander for k in range(3)] == [0.0, 0.01, 0.0]


def test_two_causes_are_two() -> None:
    rng = np.random.default_rng(1)
    for turn in range(40):
        hidden = hide("two", turn, 1.0, rng)
        assert len(set(hidden.causes)) == 2


@pytest.mark.parametrize(
    ("group", "causes", "named", "alternatives", "judgement"),
    [
        ("single", ("a",), ["a"], [], "right"),
        ("single", ("a",), ["a", "b"], [], "right, and more"),
        ("single", ("a",), ["b"], ["a"], "in the set"),
        ("single", ("a",), ["b"], [], "wrong"),
        ("two", ("a", "b"), ["b", "a"], [], "right"),
        ("two", ("a", "b"), ["a"], ["b"], "in the set"),
        ("two", ("a", "b"), ["a"], [], "one of two"),
        ("two", ("a", "b"), ["c"], [], "wrong"),
        ("outside", (), ["c"], [], "wrong"),
        ("outside", (), [], [], "unexplained"),
    ],
)
def test_judgements(
    group: str, causes: tuple[str, ...], named: list[str], alternatives: list[str], judgement: str
) -> None:
    outcome = Outcome(1, 1, Hidden(group, (), causes), "staircase", 10.0, 0.01, 0.0, False)
    outcome.verdict, outcome.named, outcome.alternatives = "unexplained", named, alternatives
    assert outcome.judgement == judgement


def test_shares_have_exact_binomial_intervals() -> None:
    # Tables for 8 of 10, for example Newcombe 1998 (doi:10.1002/sim.4780170802): 0.4439, 0.9748.
    assert share(8, 10) == pytest.approx((0.8, 0.4439, 0.9748), abs=1e-4)
    assert share(0, 10)[1] == 0.0
    assert share(10, 10)[2] == 1.0


def test_the_tables_count(capsys: pytest.CaptureFixture[str]) -> None:
    row = {
        "motor": 1,
        "number": 2,
        "hidden": {"group": "single", "defects": ["x=1"], "causes": ["a"], "strength": 1.0},
        "plan": "staircase",
        "duration_s": 12.0,
        "correlation_s": 0.01,
        "wander": 0.003,
        "wire": True,
        "n_frequencies": 1,
        "strength": 1.5,
        "rms": 1.5,
        "verdict": "explained",
        "named": ["a"],
        "alternatives": [],
        "gain": 0.9,
        "oracle_gain": 1.0,
        "fresh_gain": 0.8,
        "intervals": {"size": [1.0, 0.9, 1.1, 1.2]},
        "remainder": "",
        "error": "",
        "judgement": "right",
    }
    wrong = {**row, "judgement": "wrong", "named": ["b"], "wire": False}
    nothing = {**row, "hidden": {**row["hidden"], "group": "nothing"}, "verdict": "unexplained"}  # type: ignore[dict-item]
    two = {**row, "hidden": {**row["hidden"], "group": "two"}, "weakest": 1.2}  # type: ignore[dict-item]
    slight = {**two, "weakest": 0.1, "judgement": "one of two"}
    small = {**row, "strength": 0.3, "rms": 0.3, "told": 6.0, "gain": None, "intervals": {}}
    hidden_deep = {**small, "told": 0.0, "judgement": "no_discrepancy"}
    report([row, wrong, nothing, two, slight, small, hidden_deep])
    wrong_ones([row, wrong, nothing])
    said = capsys.readouterr().out
    assert "both of two named, each of size 1 and more         100.0 %" in said
    assert "7 draws, 6 of them through" in said
    assert "right first, size 0.2 to 0.5 x noise                50.0 %" in said
    assert "right first, small, 1.5 x what a told test finds   100.0 %" in said
    assert "a test told the form finds 51.2 % of 2 of 0.2 to 0.5 x" in said
    assert "right first, size 1 x noise and more                50.0 %" in said
    assert "false alarms, nothing hidden                       100.0 %" in said
    assert "95 % interval holds the true parameter             100.0 %" in said
    assert "-> b; staircase 12 s" in said
