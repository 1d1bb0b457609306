"""Somebody else's file becomes a run, by a mapping, or a message that names the line."""

import json
from contextlib import suppress
from importlib import resources
from math import pi
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from usmbench.errors import InputError
from usmbench.runs.foreign_run import read_foreign
from usmbench.runs.record import Record
from usmbench.settings.import_mapping import UNITS, VOLT, load_mapping

SETTINGS = settings(
    deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
PLAIN = {
    "t_s": {"from": "t", "unit": "s"},
    "phase_deg": {"from": "phi", "unit": "deg"},
    "speed_rad_s": {"from": "w", "unit": "rad/s"},
}


def mapping_file(folder: Path, columns: dict[str, Any], **keys: Any) -> Path:
    file = folder / "map.yaml"
    said = {"format": "usmbench-import/1", "columns": columns, **keys}
    file.write_text(yaml.safe_dump(said, sort_keys=False, allow_unicode=True))
    return file


def imported(folder: Path, text: str, columns: dict[str, Any], **keys: Any) -> Record:
    file = folder / "data.csv"
    file.write_text(text)
    return read_foreign(file, load_mapping(mapping_file(folder, columns, **keys)))


def refusal(folder: Path, text: str, columns: dict[str, Any], **keys: Any) -> str:
    with pytest.raises(InputError) as refused:
        imported(folder, text, columns, **keys)
    return str(refused.value)


def test_rpm_volts_and_milliseconds(tmp_path: Path) -> None:
    run = imported(
        tmp_path,
        "measured by hand\nTime (ms);Phase (V);n;T\n"
        "500,0;2,5;60;20\n510,0;7,5;120;21\n520,0;7,51;-30;nan\n",
        {
            "t_s": {"from": "Time (ms)", "unit": "ms"},
            "phase_deg": {
                "from": "Phase (V)",
                "unit": "V",
                "per_volt": 18.0,
                "zero_v": 2.5,
                "round_to": 1.0,
            },
            "speed_rad_s": {"from": "n", "unit": "rpm", "sign": -1},
            "temperature_c": {"from": "T", "unit": "°C"},
        },
        constants={"frequency_hz": 41000, "torque_nm": 0},
        csv={"delimiter": ";", "decimal": ",", "skip_lines": 1},
    )
    assert run.t_s.tolist() == pytest.approx([0.01, 0.02, 0.03])
    assert run.window_s.tolist() == pytest.approx([0.01] * 3)
    assert run.phase_deg.tolist() == [0.0, 90.0, 90.0]
    assert run.speed_rad_s.tolist() == pytest.approx([-2 * pi, -4 * pi, pi])
    assert run.frequency_hz is not None
    assert run.frequency_hz.tolist() == [41000.0] * 3
    assert run.temperature_c is not None
    assert np.isnan(run.temperature_c[2])


def test_counts_of_a_counter_that_wraps_give_angle_and_speed(tmp_path: Path) -> None:
    run = imported(
        tmp_path,
        "s,phi,pos,note\n7.00,10,65530,1\n7.01,10,65535,2\n7.02,20,4,3\n7.03,20,65534,4\n",
        {
            "t_s": {"from": "s", "unit": "s"},
            "phase_deg": {"from": "phi", "unit": "deg"},
            "angle_rad": {"from": "pos", "unit": "counts"},
        },
        encoder={"counts_per_rev": 2000, "counter_bits": 16},
        keep=["note"],
    )
    rad = 2 * pi / 2000
    assert run.angle_rad is not None
    assert run.angle_rad.tolist() == pytest.approx([5 * rad, 10 * rad, 4 * rad])
    assert run.speed_rad_s.tolist() == pytest.approx([500 * rad, 500 * rad, -600 * rad])
    assert run.t_s.tolist() == pytest.approx([0.01, 0.02, 0.03])
    assert run.phase_deg.tolist() == [10.0, 20.0, 20.0]
    assert run.extra["note"].tolist() == [2.0, 3.0, 4.0]


@pytest.mark.parametrize(("unit", "factor"), [("counts", 100.0), ("counts/s", 1.0)])
def test_counts_of_a_window_or_a_second(tmp_path: Path, unit: str, factor: float) -> None:
    columns = PLAIN | {"speed_rad_s": {"from": "w", "unit": unit}}
    run = imported(
        tmp_path, "t,phi,w\n0,0,3\n0.01,0,-4\n", columns, encoder={"counts_per_rev": 2000}
    )
    expected = np.array([3.0, -4.0]) * 2 * pi / 2000 * factor
    assert run.speed_rad_s == pytest.approx(expected)


@given(
    st.sampled_from([(name, unit) for name, units in UNITS.items() for unit in units]),
    st.floats(-1.0, 1.0),
)
@SETTINGS
def test_every_unit_has_a_factor_and_an_offset(
    tmp_path: Path, named: tuple[str, str], value: float
) -> None:
    name, unit = named
    if name in ("t_s", "window_s"):
        value = abs(value) + 1.0
    elif name in ("frequency_hz", "settled"):
        value = abs(value)
    columns = PLAIN | {name: {"from": "x", "unit": unit}}
    keys = {} if name in ("t_s", "window_s") else {"constants": {"window_s": 0.5}}
    run = imported(tmp_path, f"t,phi,w,x\n1,0,0,{value!r}\n", columns, **keys)
    found = getattr(run, name)
    factor, offset = UNITS[name][unit]
    if name == "t_s":
        assert found.tolist() == [0.01]
    else:
        assert found == pytest.approx(np.array([factor * value + offset]), abs=1e-9)


def test_known_quantities_come_out_right() -> None:
    def si(name: str, unit: str, value: float) -> float:
        factor, offset = UNITS[name][unit]
        return factor * value + offset

    assert si("temperature_c", "°F", 212.0) == pytest.approx(100.0)
    assert si("temperature_c", "K", 273.15) == pytest.approx(0.0)
    assert si("speed_rad_s", "rpm", 60.0) == pytest.approx(2 * pi)
    assert si("torque_nm", "kgf·cm", 10.0) == pytest.approx(0.980665)
    assert si("phase_deg", "rad", pi) == pytest.approx(180.0)


def test_the_schema_knows_the_same_units() -> None:
    text = resources.files("usmbench.settings").joinpath("schemas/import.schema.json").read_text()
    for name, about in json.loads(text)["properties"]["columns"]["properties"].items():
        known = set(about["properties"]["unit"]["enum"]) - {VOLT, "counts", "counts/s"}
        assert known == set(UNITS[name]), name


@pytest.mark.parametrize("version", ["5", "7.3"])
def test_a_struct_of_matlab(tmp_path: Path, version: str) -> None:
    file = tmp_path / "data.mat"
    columns = {"t": [0.0, 0.1], "phi": [0.0, 1.0], "n": [1.0, 2.0]}
    if version == "5":
        savemat(file, {"log": columns, "title": "a run"}, oned_as="column")
    else:
        with h5py.File(file, "w", userblock_size=512) as content:
            for name, values in columns.items():
                content[f"log/{name}"] = np.array([values])
            content["title"] = np.array([97, 98], np.uint16)
    mapped = {name: said | {"from": f"log.{said['from']}"} for name, said in PLAIN.items()}
    mapped["speed_rad_s"] = {"from": "log.n", "unit": "rev/s"}
    run = read_foreign(file, load_mapping(mapping_file(tmp_path, mapped)))
    assert run.speed_rad_s.tolist() == pytest.approx([2 * pi, 4 * pi])
    assert run.t_s.tolist() == pytest.approx([0.1, 0.2])


@given(st.binary(max_size=400))
@SETTINGS
def test_a_broken_mat_file_is_refused(tmp_path: Path, noise: bytes) -> None:
    file = tmp_path / "good.mat"
    savemat(file, {"t": np.arange(20.0), "phi": np.arange(20.0), "w": np.arange(20.0)})
    whole = file.read_bytes()
    broken = tmp_path / "broken.mat"
    broken.write_bytes(whole[: 128 + len(noise)] + noise)
    mapping = load_mapping(mapping_file(tmp_path, PLAIN))
    with pytest.raises(InputError):
        read_foreign(broken, mapping)


@given(st.text('0123456789.,;eE-+nainf\n\r" _x\0é', max_size=60))
@SETTINGS
def test_any_text_is_a_run_or_a_message(tmp_path: Path, text: str) -> None:
    file = tmp_path / "data.csv"
    file.write_bytes(b"t,phi,w\n" + text.encode())
    with suppress(InputError):
        run = read_foreign(file, load_mapping(mapping_file(tmp_path, PLAIN)))
        assert np.all(np.isfinite(run.speed_rad_s))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,phi,w\n0,0,0\n1,0,fast\n", "data.csv:3: w is 'fast', not a number"),
        ("t,phi,w\n0,0,1_0\n", "data.csv:2: w is '1_0'"),
        ("t,phi,w\n0,0,0\n1,0\n", "data.csv:3: 2 fields where 3 columns are named"),
        ("t,phi,w\n0,0,0\n1,0,inf\n", "data.csv:3: w is inf; mend or remove"),
        ("t,phi,w\n1,0,0\n1,0,0\n", "data.csv:3: time does not rise"),
        ("t,phi,w\n", "has no rows"),
        ("t,phi,t,w\n0,0,0,0\n", "column 't' stands twice"),
        ("t,phi\n0,0\n", "map.yaml:10: columns.speed_rad_s.from: the file has no column 'w'"),
        ('t,phi,w\n0,0,"a\n', "not a number"),
    ],
)
def test_a_wrong_file_names_the_line(tmp_path: Path, text: str, message: str) -> None:
    assert message in refusal(tmp_path, text, PLAIN)


@pytest.mark.parametrize(
    ("row", "unit", "says"),
    [
        ("1,0,1e300", "deg", "speed_rad_s is 1e+300, not -1e+12 to 1e+12; mend or remove the row"),
        ("1,1000,0", "deg", "phase_deg is 1000, not -360 to 360"),
        ("1,-1.1,0", "turn", "phase_deg is -396, not -360 to 360"),
        ("1,1e308,0", "turn", "phase_deg is inf; mend or remove the row"),
    ],
)
def test_what_no_reader_would_take_is_refused(
    tmp_path: Path, row: str, unit: str, says: str
) -> None:
    columns = PLAIN | {"phase_deg": {"from": "phi", "unit": unit}}
    assert f"data.csv:3: {says}" in refusal(tmp_path, f"t,phi,w\n0,0,0\n{row}\n", columns)


def test_the_row_of_a_speed_that_was_differenced_is_that_of_the_file(tmp_path: Path) -> None:
    columns = {name: PLAIN[name] for name in ("t_s", "phase_deg")}
    columns["angle_rad"] = {"from": "a", "unit": "rad"}
    text = "t,phi,a\n0,0,0\n1,0,1\n1.0000001,0,1e6\n"
    assert "data.csv:4: speed_rad_s is 9.9999" in refusal(tmp_path, text, columns)


def test_a_kept_column_that_the_reader_knows_is_held_to_its_limits(tmp_path: Path) -> None:
    said = refusal(tmp_path, "t,phi,w,drive_on\n0,0,0,1\n1,0,0,5\n", PLAIN, keep=["drive_on"])
    assert "data.csv:3: drive_on is 5, not 0 to 1" in said


@pytest.mark.parametrize("cell", ["1.000", "1.000,5", "1.5"])
def test_a_point_beside_a_decimal_comma_is_refused(tmp_path: Path, cell: str) -> None:
    text = f"t;phi;w\n0;0;0\n1;0;{cell}\n"
    said = refusal(tmp_path, text, PLAIN, csv={"delimiter": ";", "decimal": ","})
    assert f"data.csv:3: w is '{cell}', with a point" in said


SPEED = {"from": "w", "unit": "rad/s"}


@pytest.mark.parametrize(
    ("columns", "keys", "message"),
    [
        ({"speed_rad_s": SPEED | {"unit": "km/h"}}, {}, "map.yaml:11: columns.speed_rad_s.unit"),
        ({"speed_rad_s": SPEED | {"unit": "V"}}, {}, "say with per_volt"),
        ({"speed_rad_s": SPEED | {"per_volt": 2.0}}, {}, "per_volt is for unit V"),
        ({"speed_rad_s": SPEED | {"zero_v": 2.5}}, {}, "map.yaml:12: columns.speed_rad_s.zero_v"),
        ({"speed_rad_s": SPEED | {"unit": "counts"}}, {}, "counts need encoder"),
        (
            {"speed_rad_s": SPEED | {"unit": "counts", "round_to": 1.0}},
            {"encoder": {"counts_per_rev": 2000}},
            "map.yaml:12: columns.speed_rad_s.round_to: round_to is not for counts",
        ),
        ({"speed_rad_s": SPEED | {"form": "w"}}, {}, "did you mean from?"),
        ({"angle": SPEED}, {}, "map.yaml:13: columns.angle: unknown key"),
        ({}, {"constants": {"frequency_hz": 0}}, "constants.frequency_hz: 0 is not above 0"),
        ({}, {"constants": {"window_s": 1}, "keep": ["t_s"]}, "keep[0]: t_s is a column already"),
        ({}, {"keep": ["a", "a"]}, "keep[1]: a is a column already"),
        ({}, {"keep": ["a\nb"]}, "keep[0]: 'a\\nb' is no name"),
        (
            {"torque_nm": SPEED | {"unit": "Nm"}},
            {"constants": {"torque_nm": 0}},
            "gives it already",
        ),
        ({}, {"keep": ["absent"]}, "keep[0]: the file has no column 'absent'; it has t, phi, w"),
        ({}, {"csv": {"encoding": "utf-16"}}, "has no rows under a line"),
        ({}, {"csv": {"delimiter": ";"}}, "the file has no column 't'; it has t,phi,w"),
    ],
)
def test_a_wrong_mapping_names_the_line(
    tmp_path: Path, columns: dict[str, Any], keys: dict[str, Any], message: str
) -> None:
    assert message in refusal(tmp_path, "t,phi,w\n0,0,0\n1,0,0\n", PLAIN | columns, **keys)


def test_time_and_speed_must_come_from_somewhere(tmp_path: Path) -> None:
    without_time = {name: PLAIN[name] for name in ("phase_deg", "speed_rad_s")}
    assert "no t_s and no window_s" in refusal(tmp_path, "phi,w\n0,0\n", without_time)
    run = imported(tmp_path, "phi,w\n0,0\n0,1\n", without_time, constants={"window_s": 0.5})
    assert run.t_s.tolist() == [0.5, 1.0]
    without_speed = {name: PLAIN[name] for name in ("phase_deg", "t_s")}
    assert "neither speed_rad_s nor angle_rad" in refusal(tmp_path, "t,phi\n0,0\n", without_speed)
    angle = without_speed | {"angle_rad": {"from": "a", "unit": "rad"}}
    assert "one row shows no speed" in refusal(tmp_path, "t,phi,a\n0,0,0\n", angle)


def test_vectors_of_different_length_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "data.mat"
    savemat(file, {"t": np.arange(3.0), "phi": np.arange(3.0), "w": np.arange(4.0)})
    with pytest.raises(InputError, match=r"differ in length .*phase_deg 3, speed_rad_s 4"):
        read_foreign(file, load_mapping(mapping_file(tmp_path, PLAIN)))


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    mapping = load_mapping(mapping_file(tmp_path, PLAIN))
    for name in ("none.csv", "none.mat"):
        with pytest.raises(InputError, match="cannot be read"):
            read_foreign(tmp_path / name, mapping)


@pytest.mark.parametrize("name", ["endless.csv", "endless.mat"])
def test_what_has_no_end_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / name).symlink_to("/dev/zero")
    mapping = load_mapping(mapping_file(tmp_path, PLAIN))
    with pytest.raises(InputError, match=f"{name}: is a pipe or a device"):
        read_foreign(tmp_path / name, mapping)


def test_text_in_another_encoding_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "data.csv"
    file.write_bytes("t,phi,w\n0,0,é\n".encode("latin-1"))
    mapping = load_mapping(mapping_file(tmp_path, PLAIN))
    with pytest.raises(InputError, match=r"is not text in utf-8; say csv\.encoding"):
        read_foreign(file, mapping)
