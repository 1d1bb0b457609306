"""usmbench export and usmbench import: the way out, and the way back in."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
import yaml
from scipy.io import loadmat

from usmbench.cli.main import main
from usmbench.runs.catalogue import changed_data
from usmbench.runs.reader import read_run
from usmbench.runs.writer import RunWriter
from usmbench.sweep.rows import WindowRow

CHECKER = Path(__file__).parents[3] / "../shared/tools/check-contract"
MAPPING = """\
format: usmbench-import/1
motor: Shinsei USR60
columns:
  t_s: {from: t_s, unit: s}
  phase_deg: {from: phase_deg, unit: deg}
  speed_rad_s: {from: speed_rad_s, unit: rad/s}
  angle_rad: {from: angle_rad, unit: rad}
  sweep: {from: sweep, unit: "1"}
  settled: {from: settled, unit: "1"}
constants: {frequency_hz: 41000, torque_nm: 0.1, window_s: 0.01}
keep: [average_rad_s]
"""


@pytest.fixture
def run(tmp_path: Path) -> Path:
    folder = tmp_path / "run"
    writer = RunWriter.create(folder, {"motor": "x"}, temperature=False, raw=False)
    for k in range(1, 41):
        phase_deg, speed_rad_s = float((k - 1) // 20 * 30), 0.1 * k
        writer.window(
            WindowRow(
                k * 0.01, phase_deg, speed_rad_s, 41e3, 0.1, 0.01 * k, 0.01, 0, k % 20 > 5, 0.2, 1
            )
        )
    writer.close("completed")
    return folder


def exported(run: Path, name: str, *words: str) -> Path:
    file = run.parent / name
    assert main(["export", str(run), str(file), *words]) == 0
    return file


def test_parquet_has_the_columns_the_units_and_run_yaml(run: Path) -> None:
    table = pd.read_parquet(exported(run, "run.parquet"))
    assert table["speed_rad_s"].tolist() == read_run(run).speed_rad_s.tolist()
    assert table.index.name == "t_s"
    assert "average_rad_s" in table.columns
    assert table.attrs["units"]["torque_nm"] == "N·m"
    assert yaml.safe_load(table.attrs["run_yaml"])["motor"] == "x"


def test_netcdf_has_the_columns_the_units_and_run_yaml(run: Path) -> None:
    with xr.open_dataset(exported(run, "run.nc"), engine="h5netcdf") as data:
        assert data["speed_rad_s"].values.tolist() == read_run(run).speed_rad_s.tolist()
        assert data["phase_deg"].attrs["units"] == "deg"
        assert data["average_rad_s"].dims == ("t_s",)
        assert yaml.safe_load(data.attrs["run_yaml"])["motor"] == "x"


@pytest.mark.parametrize("ending", ["csv", "mat", "nc", "parquet"])
def test_a_run_whose_name_is_no_utf_8_is_exported(run: Path, ending: str) -> None:
    odd = run.rename(run.with_name(os.fsdecode(b"b\xffd")))
    file = exported(odd, f"run.{ending}")
    if ending == "nc":
        with xr.open_dataset(file, engine="h5netcdf") as data:
            assert data.attrs["name"].endswith("b\\udcffd")


def test_matlab_has_windows_and_pairs(run: Path) -> None:
    content = loadmat(exported(run, "run.m", "--to", "mat"), simplify_cells=True)
    assert content["run"]["average_rad_s"].tolist() == [0.2] * 40
    assert content["pairs"]["phase_deg"].tolist() == [0.0, 30.0]


@pytest.mark.parametrize("name", ["run.csv", "run.mat"])
def test_what_went_out_comes_back(run: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    file = exported(run, name)
    mapping = run.parent / "map.yaml"
    text = MAPPING
    if name == "run.mat":
        text = text.replace("{from: ", "{from: run.").replace("[average", "[run.average")
    mapping.write_text(text)
    out = run.parent / "again"
    assert main(["import", str(file), "--mapping", str(mapping), "--out", str(out)]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == str(out)
    first, again = read_run(run), read_run(out)
    for column in ("t_s", "phase_deg", "speed_rad_s", "angle_rad", "torque_nm", "settled"):
        assert np.allclose(getattr(first, column), getattr(again, column), rtol=1e-11)
    assert first.pairs is not None
    assert again.pairs is not None
    assert np.allclose(first.pairs.speed_std_rad_s, again.pairs.speed_std_rad_s, atol=1e-9)
    kept = "average_rad_s" if name == "run.csv" else "run.average_rad_s"
    assert again.extra[kept].tolist() == [0.2] * 40
    assert again.meta["imported"]["file"] == name
    assert changed_data(out) == []
    assert (out / "pairs.csv").exists()
    if CHECKER.exists():
        words = [sys.executable, str(CHECKER), "run", str(out)]
        done = subprocess.run(words, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("name", ["run.csv", "run.mat", "run.nc", "run.parquet"])
def test_what_does_not_fit_leaves_the_old_file(run: Path, name: str) -> None:
    file = run.parent / name
    file.write_text("old")
    before = sorted(run.parent.iterdir())
    words = [sys.executable, "-m", "usmbench", "export", str(run), str(file)]
    done = subprocess.run(
        ["sh", "-c", 'ulimit -f 1; exec "$@"', "sh", *words], capture_output=True, text=True
    )
    assert done.returncode == 2
    assert done.stderr.startswith(f"usmbench: {file}: cannot be written (File too large); raise")
    assert done.stderr.count("\n") == 1
    assert file.read_text() == "old"
    assert sorted(run.parent.iterdir()) == before


def test_names_that_a_format_cannot_take_are_changed_and_nothing_is_lost(tmp_path: Path) -> None:
    names = ["a/b", "a_b", "", "1x", "_x", "y" * 80, "y" * 81, "π", "t.s", "note"]
    rows = [[k] * 2 + [10 * k + i for i in range(9)] + ["é$"] for k in (1, 2)]
    table = pd.DataFrame(rows, columns=["phase_deg", "speed_rad_s", *names])
    run = tmp_path / "wide.csv"
    table.to_csv(run, index=False)
    for ending in ("csv", "parquet", "nc", "mat"):
        assert main(["export", str(run), str(tmp_path / f"out.{ending}")]) == 0
    assert pd.read_parquet(tmp_path / "out.parquet")["a/b"].tolist() == [10.0, 20.0]
    with xr.open_dataset(tmp_path / "out.nc", engine="h5netcdf") as data:
        assert data["a_b"].values.tolist() == [11.0, 21.0]
        assert data["a_b_2"].attrs["long_name"] == "a/b"
        assert data["note"].values.tolist() == ["é$", "é$"]
        assert len(data.data_vars) == 3 + len(names)
    content = loadmat(tmp_path / "out.mat", simplify_cells=True)["run"]
    assert content["a_b_2"].tolist() == [10.0, 20.0]
    assert content["x_x"].tolist() == [14.0, 24.0]
    assert len(content) == 4 + len(names)


def test_an_unknown_operating_point_leaves_the_pairs_to_the_reader(tmp_path: Path) -> None:
    mapping, data, out = tmp_path / "map.yaml", tmp_path / "data.csv", tmp_path / "run"
    mapping.write_text(
        "format: usmbench-import/1\nconstants: {window_s: 0.01}\ncolumns:\n"
        "  phase_deg: {from: p, unit: deg}\n  speed_rad_s: {from: w, unit: rpm}\n"
    )
    data.write_text("p,w\n" + "0,60\n" * 9 + "10,90\n" * 9)
    assert main(["import", str(data), "--mapping", str(mapping), "--out", str(out)]) == 0
    pairs = read_run(out).pairs
    assert pairs is not None
    assert pairs.phase_deg.tolist() == [0.0, 10.0]
    assert not (out / "pairs.csv").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["export", "RUN", "run.xyz"], "add --to csv|mat|netcdf|parquet"),
        (["export", "RUN", "run/pairs.csv"], "pairs.csv: is part of the run run; name another"),
        (["export", "none", "run.csv"], "none: "),
        (["export", "RUN", "none/run.csv"], "cannot be written"),
        (["export", "RUN", "none/run.mat"], "cannot be written"),
        (["export", "RUN", "none/run.nc"], "cannot be written"),
        (["export", "RUN", "none/run.parquet"], "cannot be written"),
        (["export", "RUN", "run", "--to", "csv"], "run: is what this command reads"),
        (["import", "none.csv", "--mapping", "map.yaml", "--out", "x"], "none.csv: cannot be read"),
        (["import", "data.csv", "--mapping", "none.yaml", "--out", "x"], "none.yaml: cannot be"),
        (["import", "data.csv", "--mapping", "map.yaml", "--out", "run"], "run: exists already"),
        (["import", "data.csv", "--out", "x"], "--mapping"),
    ],
)
def test_wrong_usage_is_one_line_and_status_2(
    run: Path,
    words: list[str],
    message: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(run.parent)
    Path("map.yaml").write_text(MAPPING.replace("keep: [average_rad_s]\n", ""))
    Path("data.csv").write_text("t_s,phase_deg,speed_rad_s,angle_rad,sweep,settled\n1,0,0,0,0,1\n")
    assert main(["run" if word == "RUN" else word for word in words]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert message in said
