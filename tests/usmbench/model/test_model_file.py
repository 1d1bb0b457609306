"""A model survives its file; a file that is none is refused with its name."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from usmbench.errors import InputError
from usmbench.model.hammerstein import (
    HammersteinModel,
    LinearPart,
    OperatingPoint,
    StaticCurve,
)
from usmbench.model.model_file import read_model, write_model


def model() -> HammersteinModel:
    curve = StaticCurve(np.array([-90.0, 1 / 3, 90.0]), np.array([-10.0, 0.1, 10.0]))
    point = OperatingPoint(41_000.0, 0.1, curve, (-88.0, 90.0), (-5.5, None), 0.01)
    return HammersteinModel(
        LinearPart(np.array([-0.05]), np.array([0.5, 0.45]), 1, 0.01, 8.5),
        (point,),
        "fast",
        fitted_on=({"name": "runs/a", "rows": 100},),
        residual={"rmse_free_run_rad_s": 0.02},
        intervals={"tau_s": [0.003, 0.004]},
        unexplained=({"question": "other dynamics act on the input", "p_value": 1e-9},),
        effects=({"name": "phase_offset", "parameters": {"offset_deg": 2.0}},),
    )


def test_what_is_written_is_read_back_to_the_last_bit(tmp_path: Path) -> None:
    path = tmp_path / "model.yaml"
    write_model(path, model())
    read = read_model(path)
    assert read.points[0].curve.knots_deg.tolist() == [-90.0, 1 / 3, 90.0]
    assert read.linear.b.tolist() == [0.5, 0.45]
    assert read.linear.slip_limit_rad_s == 8.5
    assert read.points[0].dead_zone_deg == (-5.5, None)
    for name in ("method", "fitted_on", "residual", "intervals", "unexplained", "effects"):
        assert getattr(read, name) == getattr(model(), name)


def test_a_dead_zone_that_is_null_has_no_edges(tmp_path: Path) -> None:
    path = tmp_path / "model.yaml"
    write_model(path, model())
    text = path.read_text(encoding="utf-8")
    path.write_text(re.sub(r"dead_zone_deg: .*", "dead_zone_deg: null", text), encoding="utf-8")
    assert read_model(path).points[0].dead_zone_deg == (None, None)


def test_the_file_says_its_version_and_a_newer_one_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "model.yaml"
    write_model(path, model())
    text = path.read_text(encoding="utf-8")
    assert "format: usmbench-model/1\n" in text
    path.write_text(text.replace("usmbench-model/1", "usmbench-model/2"), encoding="utf-8")
    with pytest.raises(InputError, match=r"model.yaml: was written by a newer usmbench"):
        read_model(path)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("usmbench-model/1", "usmbench-run/1", "is no model file"),
        ("usmbench-model/1", "usmbench-model/²", "is no model file"),
        ("usmbench-model/1", "usmbench-model/" + 5000 * "9", "is no model file"),
        ("method: fast", "method: [", "is not YAML"),
        ("window_s: 0.01", "other: 0.01", r"linear: has no key window_s"),
        ("dead_time_windows: 1", "dead_time_windows: many", "'many' is not a whole number"),
        ("a: [-0.05]", "a: [-0.05, 0.2]", r"slip_limit_rad_s: needs one a between -1 and 0"),
        ("b: [0.5, 0.45]", "b: [0.5]", r"slip_limit_rad_s: needs .* b that add up to 1 \+ a"),
        ("b: [0.5, 0.45]", "b: [0.0]", "linear.b: adds up to 0"),
        ("b: [0.5, 0.45]", "b: [0.1, 0.2, -0.3]", "linear.b: adds up to 0"),
        ("a: [-0.05]", "a: [-1.5]", r"linear.a: has a pole of size 1 or more"),
        ("[-88.0, 90.0]", "[90.0, -88.0]", "phase_range_deg: gives the lowest phase first"),
        ("[-5.5, null]", "[5.5, -5.5]", "dead_zone_deg: gives the lowest phase first"),
        ("[-5.5, null]", "[-5.5, 1.0e+11]", r"dead_zone_deg\[1\]: .* is above 360"),
        ("frequency_hz: 41000.0", "frequency_hz: -1", r"frequency_hz: -1 is not above 0"),
        ("noise_rad_s: 0.01", "noise_rad_s: -1", r"points\[0\].noise_rad_s: -1 is below 0"),
        ("run_rad_s: 0.02", "run_rad_s: many", r"rmse_free_run_rad_s: 'many' is not a number"),
        ("run_rad_s: 0.02", "run_rad_s: 0.02\n  diagnosis: 3", "diagnosis: 3 is not a mapping"),
        ("phase_offset", "gremlins", "effects: the cause 'gremlins' .* is not installed"),
        ("offset_deg: 2.0", "other: 2.0", "effects: the model's effect phase_offset lacks"),
        ("a: [-0.05]", f"a: {5001 * [0.0001]}", "linear.a: has 5001 entries; give at most 100"),
        ("b: [0.5, 0.45]", f"b: {1001 * [0.1]}", "linear.b: has 1001 entries; give at most 1000"),
        ("a: [-0.05]", "a: [.nan]", r"linear.a\[0\]: not a number"),
        ("knots_deg: [-90.0,", "knots_deg: [95.0,", r"points\[0\].knots_deg: the knots must rise"),
        ("delta_rad_s: [-10.0, 0.1, 10.0]", "delta_rad_s: [1.0, 2.0]", "2 ordinates for 3 knots"),
    ],
)
def test_a_spoilt_file_is_refused_by_name(tmp_path: Path, old: str, new: str, words: str) -> None:
    path = tmp_path / "model.yaml"
    write_model(path, model())
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match=words) as caught:
        read_model(path)
    assert str(caught.value).startswith(str(path))
    if "format" not in words and "no model" not in words:
        assert caught.value.line is not None


def test_a_file_that_was_cut_off_is_no_model(tmp_path: Path) -> None:
    """Wherever the cut is: short of an effect, it would be the file of another motor."""
    path = tmp_path / "model.yaml"
    late = {"name": "transport_delay", "form": "", "parameters": {"delay_s": 0.5}}
    write_model(path, replace(model(), effects=(*model().effects, late)))
    text = path.read_text(encoding="utf-8").rstrip()
    first = text.index("method:")
    for end in range(first, len(text)):
        path.write_text(text[:end], encoding="utf-8")
        with pytest.raises(InputError, match=r"was the file cut off\?|is not YAML|not plain"):
            read_model(path)
    path.write_text(text, encoding="utf-8")
    assert read_model(path).effects == (*model().effects, late)


@pytest.mark.parametrize("end", ["", "effects:\n", "effects: null\n"])
def test_what_stands_before_the_effects_is_not_enough(tmp_path: Path, end: str) -> None:
    path = tmp_path / "model.yaml"
    write_model(path, model())
    before = path.read_text(encoding="utf-8").partition("effects:")[0]
    path.write_text(before + end, encoding="utf-8")
    with pytest.raises(
        InputError, match=r"no key effects: was the file cut off\? .* effects: \[\]$"
    ):
        read_model(path)
    path.write_text(before + "effects: []\n", encoding="utf-8")
    assert read_model(path).effects == ()


def test_effects_one_below_the_other_are_read_too(tmp_path: Path) -> None:
    path = tmp_path / "model.yaml"
    write_model(path, model())
    before = path.read_text(encoding="utf-8").partition("effects:")[0]
    below = "effects:\n- name: phase_offset\n  parameters:\n    offset_deg: 2.0\n"
    path.write_text(before + below, encoding="utf-8")
    assert read_model(path).effects == model().effects


def test_a_missing_file_and_a_folder_that_is_none_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_model(tmp_path / "none.yaml")
    with pytest.raises(InputError, match="cannot be written"):
        write_model(tmp_path / "none" / "model.yaml", model())


def test_keys_of_the_users_own_are_ignored(tmp_path: Path) -> None:
    path = tmp_path / "model.yaml"
    write_model(path, model())
    path.write_text(path.read_text(encoding="utf-8") + "note: mine\n", encoding="utf-8")
    assert read_model(path).method == "fast"


def test_a_model_of_many_points_is_read_back(tmp_path: Path) -> None:
    path = tmp_path / "model.yaml"
    large = replace(model(), residual={"known": "x" * 1_200_000})
    write_model(path, large)
    assert path.stat().st_size > 1_000_000
    assert read_model(path).residual == large.residual
