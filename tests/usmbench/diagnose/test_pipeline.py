"""A motor known to the last figure, an effect put into its runs, and what diagnose says."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.diagnose import found as found_module
from usmbench.diagnose import stepwise
from usmbench.diagnose.gain import held_out_gain
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.errors import InputError
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.effects.base import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import Applied, extended_run
from usmbench.model.hammerstein import HammersteinModel, StaticCurve
from usmbench.model.model_file import read_model, write_model
from usmbench.runs.record import Record

Array = NDArray[np.float64]
WINDOW_S, NOISE_RAD_S = 0.01, 0.02
CURVE = StaticCurve(
    np.array([-90.0, -60, -30, -15, -8, -3, 3, 8, 15, 30, 60, 90]),
    np.array([-10.3, -10.1, -8, 0, 0, 0, 0, 0, 0, 8, 10.2, 10.4]),
)
LINEAR = first_order(0.0035, 0.0015, WINDOW_S)


def _measured(seed: int, *effects: Applied, n: int = 2000) -> Record:
    rng = np.random.default_rng(seed)
    phase_deg = np.repeat(rng.uniform(-88.0, 88.0, n // 5), 5)
    phase_deg[:2], phase_deg[n // 2 : n // 2 + 2] = -89.0, 89.0
    return _driven(phase_deg, seed, *effects)


def _driven(phase_deg: Array, seed: int, *effects: Applied) -> Record:
    n = phase_deg.size
    t_s = WINDOW_S * np.arange(1.0, n + 1.0)
    context = Context(t_s, WINDOW_S, phase_deg, CURVE.speed_rad_s, LINEAR)
    speed = extended_run(effects, context).speed_rad_s
    noisy = speed + NOISE_RAD_S * np.random.default_rng([seed, 1]).standard_normal(n)
    return Record(f"run {seed}", t_s, phase_deg, noisy, np.full(n, WINDOW_S))


def _applied(name: str, form: str, **values: float) -> Applied:
    return Applied(find_effect(name, form), values)


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    runs = [_measured(1), _measured(2)]
    return with_knowledge(identify_fast(runs, FastOptions(12)).model, runs)


def test_finds_nothing_where_nothing_is(model: HammersteinModel) -> None:
    found = diagnose([_measured(5)], model)
    assert found.verdict == "no_discrepancy"
    assert found.causes == ()
    assert found.extended == model
    sizes = {d.cause: d.value for d in found.minimum_detectable}
    assert sizes["gain_asymmetry"] is not None
    assert 0.0 < sizes["gain_asymmetry"] < 0.05


@pytest.mark.parametrize(
    ("hidden", "parameter"),
    [
        (_applied("gain_asymmetry", "balanced", asymmetry=0.04), "asymmetry"),
        (_applied("transport_delay", "", delay_s=0.004), "delay_s"),
        (_applied("load_torque", "weight", one_sided_rad_s=0.1), "one_sided_rad_s"),
        (_applied("unsigned_counts", ""), None),
    ],
    ids=lambda value: value.effect.name if isinstance(value, Applied) else "",
)
def test_names_what_was_hidden(
    model: HammersteinModel, hidden: Applied, parameter: str | None
) -> None:
    found = diagnose([_measured(7, hidden)], model)
    (cause,) = found.causes
    assert cause.name == hidden.effect.name
    assert found.verdict == "explained"
    assert found.gain > 0.9
    assert len(found.extended.effects) == 1
    if parameter is not None:
        sizes = {p.name: p for p in cause.parameters}
        assert sizes[parameter].value == pytest.approx(hidden.values[parameter], rel=0.1)


@pytest.mark.parametrize(
    "hidden",
    [
        _applied("transport_delay", "", delay_s=3e-4),
        _applied("slow_dynamics", "", added_s=3e-4),
        _applied("coupling_backlash", "", gap_rad=1.5e-3),
    ],
    ids=lambda applied: applied.effect.name,
)
def test_a_small_part_of_a_window_or_a_count_is_named(
    model: HammersteinModel, hidden: Applied
) -> None:
    found = diagnose([_measured(9, hidden)], model)
    assert found.causes[0].name == hidden.effect.name


def test_a_cause_that_explains_nothing_of_unseen_blocks_is_not_named(
    model: HammersteinModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = _measured(7, _applied("gain_asymmetry", "balanced", asymmetry=0.04))
    assert diagnose([record], model).causes
    monkeypatch.setattr(stepwise, "held_out_drop", lambda *_: np.zeros(4))
    found = diagnose([record], model)
    assert found.verdict == "unexplained"
    assert found.causes == ()
    assert found.extended == model
    assert found.gain == 0.0


@pytest.mark.parametrize("share", [0.12, 0.5])
def test_counts_that_a_filter_swallows_by_chance_are_missed_counts(
    model: HammersteinModel, share: float
) -> None:
    rng = np.random.default_rng(3)
    record = _driven(np.repeat(rng.uniform(-88.0, 88.0, 100), 20), 13)
    four_counts_rad_s = 4.0 * 2.0 * np.pi / 2000.0 / WINDOW_S
    fast = np.abs(record.speed_rad_s) > 0.95 * np.max(np.abs(record.speed_rad_s))
    lost = rng.binomial(7, share / 7, fast.size) * fast
    counted = record.speed_rad_s - np.sign(record.speed_rad_s) * four_counts_rad_s * lost
    found = diagnose([replace(record, speed_rad_s=counted)], model)
    assert found.verdict in {"explained", "partly_explained"}
    assert [cause.name for cause in found.causes] == ["missed_counts"]


@pytest.mark.parametrize(
    ("counts_per_rev", "first"), [(2000, "speed_scale"), (None, "missed_counts")]
)
def test_what_takes_away_no_whole_counts_is_hardly_lost_counts(
    model: HammersteinModel, counts_per_rev: int | None, first: str
) -> None:
    slower = _applied("missed_counts", "of all", share_lost=0.01, above_rad_s=1.0)
    record = replace(_measured(13, slower), meta={"encoder": {"counts_per_rev": counts_per_rev}})
    (cause,) = diagnose([record], model).causes
    assert cause.name == first


def test_what_swallowed_counts_cover_is_named_from_slower_windows(model: HammersteinModel) -> None:
    rng = np.random.default_rng(3)
    offset = _applied("phase_offset", "", offset_deg=0.5)
    record = _driven(np.repeat(rng.uniform(-88.0, 88.0, 100), 20), 13, offset)
    four_counts_rad_s = 4.0 * 2.0 * np.pi / 2000.0 / WINDOW_S
    fast = np.abs(record.speed_rad_s) > 0.95 * np.max(np.abs(record.speed_rad_s))
    lost = rng.binomial(7, 0.5, fast.size) * fast
    counted = record.speed_rad_s - np.sign(record.speed_rad_s) * four_counts_rad_s * lost
    found = diagnose([replace(record, speed_rad_s=counted)], model)
    assert [cause.name for cause in found.causes] == ["missed_counts", "phase_offset"]
    (found_deg,) = found.causes[1].parameters
    assert found_deg.value == pytest.approx(0.5, rel=0.05)


def test_a_small_cause_is_named_beside_a_large_one_that_hardly_acts_where_it_does(
    model: HammersteinModel,
) -> None:
    rng = np.random.default_rng(3)
    late = _applied("transport_delay", "", delay_s=0.006)
    warms = _applied("thermal_drift", "speed", final_drift=-0.01, warm_up_s=15.0)
    found = diagnose(
        [_driven(np.repeat(rng.uniform(-88.0, 88.0, 100), 20), 13, late, warms)], model
    )
    assert [cause.name for cause in found.causes] == ["transport_delay", "thermal_drift"]


def test_false_counts_are_named_from_windows_too_slow_to_swallow_any(
    model: HammersteinModel,
) -> None:
    rng = np.random.default_rng(3)
    record = _driven(np.repeat(rng.uniform(-88.0, 88.0, 100), 20), 13)
    count_rad_s = 2.0 * np.pi / 2000.0 / WINDOW_S
    fast = np.abs(record.speed_rad_s) > 0.95 * np.max(np.abs(record.speed_rad_s))
    lost = 4.0 * rng.binomial(7, 0.5, fast.size) * fast
    false = rng.choice([-1.0, 1.0], fast.size) * (rng.uniform(size=fast.size) < 0.02)
    counted = record.speed_rad_s + count_rad_s * (false - np.sign(record.speed_rad_s) * lost)
    found = diagnose([replace(record, speed_rad_s=counted)], model)
    assert [cause.name for cause in found.causes] == ["missed_counts", "count_glitches"]


@pytest.mark.parametrize(
    ("counts_per_rev", "causes"),
    [(2000, ["count_glitches"]), (None, ["count_glitches"]), (200, [])],
)
def test_false_counts_stand_out_soon_after_a_jump_by_a_good_part_of_a_count(
    model: HammersteinModel, counts_per_rev: int | None, causes: list[str]
) -> None:
    record = replace(_measured(21), meta={"encoder": {"counts_per_rev": counts_per_rev}})
    runs_on = np.arange(record.t_s.size) % 5 == 3
    rows = np.flatnonzero(runs_on & (np.abs(record.speed_rad_s) > 3.0))[::25]
    glitches = np.zeros(runs_on.size)
    glitches[rows] = 0.5 * np.where(np.arange(rows.size) % 2, 1.0, -1.0)
    found = diagnose([replace(record, speed_rad_s=record.speed_rad_s + glitches)], model)
    assert [cause.name for cause in found.causes] == causes


@pytest.mark.parametrize(("swing", "named"), [(0.0, ["load_torque"]), (0.5, [])])
def test_what_looks_like_a_weight_and_swings_with_the_angle_has_no_name(
    model: HammersteinModel, swing: float, named: list[str]
) -> None:
    record = _measured(23)
    loaded = _measured(23, _applied("load_torque", "weight", one_sided_rad_s=0.15))
    angle_rad = WINDOW_S * np.cumsum(record.speed_rad_s)
    share = 1.0 + swing * np.sin(0.3 * angle_rad)
    speed_rad_s = record.speed_rad_s + share * (loaded.speed_rad_s - record.speed_rad_s)
    found = diagnose([replace(record, speed_rad_s=speed_rad_s)], model)
    assert [cause.name for cause in found.causes] == named
    assert found.verdict == ("explained" if named else "unexplained")


def test_friction_at_one_speed_is_no_loss_of_counts(model: HammersteinModel) -> None:
    record = _measured(25)
    slower = 0.2 * np.exp(-((np.abs(record.speed_rad_s) - 5.0) ** 2))
    sung = record.speed_rad_s - slower * np.sign(record.speed_rad_s)
    assert diagnose([replace(record, speed_rad_s=sung)], model).verdict == "unexplained"


def test_scatter_at_high_speed_that_is_no_loss_has_no_name(model: HammersteinModel) -> None:
    record = _measured(13)
    fast = np.abs(record.speed_rad_s) > 0.95 * np.max(np.abs(record.speed_rad_s))
    shaken = 1.3 * np.random.default_rng(4).standard_normal(fast.size) * fast
    found = diagnose([replace(record, speed_rad_s=record.speed_rad_s + shaken)], model)
    assert found.verdict == "unexplained"


@pytest.mark.parametrize(("reversals", "named"), [(2, False), (60, True)])
def test_a_cause_that_acts_on_a_handful_of_windows_is_not_named(
    model: HammersteinModel, reversals: int, named: bool
) -> None:
    phase_deg = 60.0 * np.sign(np.sin(np.arange(2000) * np.pi * (reversals + 0.5) / 2000.0 + 1e-6))
    found = diagnose(
        [_driven(phase_deg, 17, _applied("coupling_backlash", "", gap_rad=0.1))], model
    )
    assert ("coupling_backlash" in [cause.name for cause in found.causes]) == named


_THREE = (
    _applied("gain_asymmetry", "balanced", asymmetry=0.03),
    _applied("transport_delay", "", delay_s=0.003),
    _applied("phase_quantisation", "rounded", step_deg=5.0),
)


def test_three_causes_at_once_have_no_name(
    model: HammersteinModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = _measured(11, *_THREE)
    found = diagnose([record], model)
    assert (found.verdict, found.causes) == ("unexplained", ())
    assert found.extended == model
    monkeypatch.setattr(found_module, "_MOST_NAMED", 3)
    assert {c.name for c in diagnose([record], model).causes} == {a.effect.name for a in _THREE}


@pytest.mark.parametrize(("n_named", "says"), [(1, "partly_explained"), (2, "unexplained")])
def test_several_causes_that_leave_something_have_no_name(
    model: HammersteinModel, monkeypatch: pytest.MonkeyPatch, n_named: int, says: str
) -> None:
    monkeypatch.setattr(found_module, "verdict", lambda *_: "partly_explained")
    assert diagnose([_measured(12, *_THREE[:n_named])], model).verdict == says


def test_a_cause_that_leaves_something_and_gains_nothing_has_no_name(
    model: HammersteinModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(found_module, "verdict", lambda *_: "partly_explained")
    monkeypatch.setattr(
        found_module, "held_out_gain", lambda *args: replace(held_out_gain(*args), gain=0.0)
    )
    assert diagnose([_measured(12, _THREE[0])], model).verdict == "unexplained"


def test_a_cause_that_looks_a_little_like_two_others_is_not_named(model: HammersteinModel) -> None:
    offset = _applied("phase_offset", "", offset_deg=0.8)
    found = diagnose([_measured(12, offset, _THREE[0])], model)
    assert found.verdict == "explained"
    assert {cause.name for cause in found.causes} == {"phase_offset", "gain_asymmetry"}


def test_noise_that_has_grown_is_a_finding(model: HammersteinModel) -> None:
    record = _measured(13)
    louder = 3.0 * NOISE_RAD_S * np.random.default_rng(14).standard_normal(record.t_s.size)
    found = diagnose([replace(record, speed_rad_s=record.speed_rad_s + louder)], model)
    assert (found.verdict, found.causes) == ("unexplained", ())
    assert found.remainder is not None
    assert found.remainder.versus == "noise"


def test_says_so_where_no_cause_fits(model: HammersteinModel) -> None:
    record = _measured(9)
    # Every third second the shaft runs backwards against its commands: nothing does that.
    odd = np.where(np.floor(record.t_s) % 3 == 0, -0.4, 0.9) * record.speed_rad_s
    found = diagnose([replace(record, speed_rad_s=odd)], model)
    assert found.verdict in {"unexplained", "partly_explained"}
    assert found.remainder is not None


def test_the_same_runs_give_the_same_words(model: HammersteinModel) -> None:
    record = _measured(11, _applied("speed_scale", "", scale_error=0.01))
    assert diagnose([record], model).to_json() == diagnose([record], model).to_json()


def test_what_is_known_comes_back_from_the_model_file(
    model: HammersteinModel, tmp_path: Path
) -> None:
    write_model(tmp_path / "model.yaml", model)
    again = read_model(tmp_path / "model.yaml")
    assert again.residual["diagnosis"] == model.residual["diagnosis"]


class TestBadInput:
    def test_runs_of_two_motors(self, model: HammersteinModel) -> None:
        one, two = (replace(_measured(k, n=500), meta={"motor": f"motor {k}"}) for k in (1, 2))
        with pytest.raises(InputError, match="do not belong together"):
            diagnose([one, two], model)

    def test_a_run_too_short(self, model: HammersteinModel) -> None:
        with pytest.raises(InputError, match="measure at least"):
            diagnose([_measured(3, n=40)], model)

    def test_a_speed_that_is_no_number(self, model: HammersteinModel) -> None:
        record = _measured(3, n=500)
        record.speed_rad_s[17] = np.nan
        with pytest.raises(InputError, match="row 17 is no number"):
            diagnose([record], model)

    def test_a_run_outside_the_model(self, model: HammersteinModel) -> None:
        record = _measured(3, n=500)
        with pytest.raises(InputError, match="outside"):
            diagnose([replace(record, phase_deg=record.phase_deg + 150.0)], model)

    def test_other_windows(self, model: HammersteinModel) -> None:
        record = _measured(3, n=500)
        slow = replace(record, window_s=2.0 * record.window_s, t_s=2.0 * record.t_s)
        with pytest.raises(InputError, match="windows of 20 ms"):
            diagnose([slow], model)

    def test_a_shaft_that_hardly_turns_cannot_show_the_disc(self, model: HammersteinModel) -> None:
        record = _measured(3, n=500)
        still = replace(record, phase_deg=np.zeros(500), speed_rad_s=np.zeros(500))
        found = diagnose([still], model)
        assert "encoder_eccentricity" in dict(found.not_testable)

    def test_damaged_knowledge(self, model: HammersteinModel) -> None:
        broken = replace(model, residual={"diagnosis": {"noise": 3}})
        with pytest.raises(InputError, match="is damaged"):
            diagnose([_measured(3, n=500)], broken)
