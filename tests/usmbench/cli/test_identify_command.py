"""usmbench identify, from the command line to its files."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from usmbench.cli.main import main
from usmbench.model.model_file import read_model

CHECKER = Path(__file__).parents[4] / "shared" / "tools" / "check-contract"
Run = Callable[..., Path]


@pytest.fixture
def run_csv(tmp_path: Path) -> Run:
    """Return a function that writes a bare CSV of dwells with a dead zone."""

    def write(name: str = "run.csv", *, n: int = 600, columns: str = "") -> Path:
        rng = np.random.default_rng(0)
        phase_deg = np.repeat(rng.uniform(-90.0, 90.0, n // 10 + 1), 10)[:n]
        settled = np.sign(phase_deg) * np.maximum(np.abs(phase_deg) - 10.0, 0.0) / 8.0
        speed = np.empty(n)
        before = settled[0]
        for k, level in enumerate(settled):
            speed[k] = 0.5 * level + 0.5 * before
            before = level
        speed += 0.01 * rng.standard_normal(n)
        path = tmp_path / name
        lines = [f"{p},{s}{columns}" for p, s in zip(phase_deg, speed, strict=True)]
        header = "phase_deg,speed_rad_s" + (",frequency_hz,torque_nm" if columns else "")
        path.write_text("\n".join([header, *lines]) + "\n")
        return path

    return write


def check_contract(what: str, path: Path) -> None:
    """Hold a file against the contract where its checker is at hand."""
    if CHECKER.is_file():
        subprocess.run([sys.executable, CHECKER, what, path], check=True, capture_output=True)


@pytest.mark.parametrize("method", ["fast", "paper"])
def test_model_and_figures_are_written(
    run_csv: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str], method: str
) -> None:
    model, figures = tmp_path / "model.yaml", tmp_path / "figures.json"
    words = ["identify", str(run_csv()), "--out", str(model), "--method", method]
    assert main([*words, "--json", str(figures)]) == 0
    content = json.loads(figures.read_text())
    assert content["method"] == method
    assert content["n"] > 0
    assert content["gain_linear"] == pytest.approx(1.0)
    assert content["dead_zone_deg"] == pytest.approx([-10.0, 10.0], abs=2.0)
    assert read_model(model).method == method
    assert f"model written to {model}" in capsys.readouterr().out
    check_contract("identify", figures)


def test_runs_give_the_same_model_in_any_order(run_csv: Run, tmp_path: Path) -> None:
    runs = [str(run_csv(f"{n}.csv", n=n)) for n in (500, 400, 600)]
    models = []
    for k, order in enumerate((runs, [runs[1], runs[2], runs[0]])):
        models.append(tmp_path / f"model{k}.yaml")
        assert main(["identify", *order, "--out", str(models[k])]) == 0
    assert len({model.read_text() for model in models}) == 1


def test_a_run_that_says_no_frequency_is_at_that_of_the_others(
    run_csv: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    runs = [str(run_csv("a.csv", columns=",41000,0")), str(run_csv("b.csv", n=500))]
    model = tmp_path / "m.yaml"
    assert main(["identify", *runs, "--out", str(model)]) == 0
    assert [p.frequency_hz for p in read_model(model).points] == [41000.0]
    assert "b.csv: no column frequency_hz: taken for 41000 Hz" in capsys.readouterr().err


def test_several_points_are_listed(run_csv: Run, tmp_path: Path) -> None:
    runs = [
        str(run_csv("a.csv", columns=",41000,0")),
        str(run_csv("b.csv", columns=",42000,0.1")),
    ]
    figures = tmp_path / "figures.json"
    assert main(["identify", *runs, "--out", str(tmp_path / "m.yaml"), "--json", str(figures)]) == 0
    points = json.loads(figures.read_text())["points"]
    assert [(p["frequency_hz"], p["torque_nm"]) for p in points] == [(41000, 0), (42000, 0.1)]
    check_contract("identify", figures)


def test_json_to_standard_output_is_alone_there(
    run_csv: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = str(tmp_path / "m.yaml")
    assert main(["identify", str(run_csv()), "--out", out, "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out)["n"] == 600


def test_degree_knots_and_orders_are_kept(run_csv: Run, tmp_path: Path) -> None:
    figures = tmp_path / "figures.json"
    words = ["identify", str(run_csv()), "--out", str(tmp_path / "m.yaml"), "--json", str(figures)]
    assert main([*words, "--degree", "18", "--na", "2", "--nb", "1"]) == 0
    content = json.loads(figures.read_text())
    assert (len(content["delta"]), len(content["a"]), len(content["b"])) == (19, 2, 2)
    assert main([*words, "--knots", "-90,-20,-10,0,10,20,90"]) == 0
    assert json.loads(figures.read_text())["knots_deg"] == [-90, -20, -10, 0, 10, 20, 90]


def test_the_papers_search_leaves_its_trace(run_csv: Run, tmp_path: Path) -> None:
    trace = tmp_path / "trace.csv"
    words = ["identify", str(run_csv()), "--out", str(tmp_path / "m.yaml"), "--method", "paper"]
    assert main([*words, "--seed", "3", "--trace", str(trace)]) == 0
    header, *rows = trace.read_text().splitlines()
    assert header == "iteration,sse,mu,lambda,accepted"
    first = trace.read_text()
    sse = [float(row.split(",")[1]) for row in rows if row.endswith(",1")]
    assert len(sse) > 5
    assert sse == sorted(sse, reverse=True)
    assert main([*words, "--seed", "3", "--trace", str(trace)]) == 0
    assert trace.read_text() == first


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--knots", "-90,0,0,90"], "the knots must rise"),
        (["--knots", "-90,x,90"], "is no list of numbers"),
        (["--knots", "-45,0,45"], "outside the knots"),
        (["--degree", "0"], "--degree 0 is too low"),
        (["--na", "-1"], "--na -1 is too low"),
        (["--degree", "3", "--knots", "-90,0,90"], "give one of them"),
        (["--method", "slow"], "invalid choice"),
        (["--trace", "t.csv"], "belong to --method paper"),
        (["--method", "paper", "--seed", "-1"], "--seed -1 is negative"),
        (["--method", "paper", "--trace", "none/t.csv"], "cannot be written"),
        (["--json", "none/x.json"], "cannot be written"),
    ],
)
def test_wrong_usage_is_one_line_and_status_2(
    run_csv: Run,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    message: str,
) -> None:
    out = str(tmp_path / "m.yaml")
    assert main(["identify", str(run_csv()), "--out", out, *words]) == 2
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 1
    assert message in errors[0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("phase_deg,speed_rad_s\n30,1\n30,2\n30,1\n", "the phase is 30° throughout"),
        ("phase_deg,speed_rad_s\n0,0\n30,nan\n", "speed_rad_s is nan"),
        ("phase_deg,speed_rad_s\n0,0\n30,1\n60,2\n", "only 3 windows were driven; a curve and"),
        ("phase_deg,speed_rad_s\n" + 40 * "0,0\n90,1\n", "0° or 90° and never between; a curve ne"),
        ("phase_deg,speed_rad_s\n", ""),
        ("t_s,phase_deg,speed_rad_s\n0.02,0,1\n0.01,5,2\n", "t_s does not rise"),
    ],
)
def test_bad_data_is_one_line_and_status_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, message: str
) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(text)
    assert main(["identify", str(path), "--out", str(tmp_path / "m.yaml")]) == 2
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 1
    assert "bad.csv" in errors[0]
    assert message in errors[0]
    assert not (tmp_path / "m.yaml").exists()
