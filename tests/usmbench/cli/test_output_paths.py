"""Every command looks at its output files before it begins, and never writes over a run."""

from pathlib import Path

import pytest

from usmbench.cli.main import main


@pytest.mark.parametrize(
    "words",
    [
        ["identify", "run", "--out", "FILE"],
        ["identify", "run", "--out", "m.yaml", "--json", "FILE"],
        ["identify", "run", "--out", "m.yaml", "--method", "paper", "--trace", "FILE"],
        ["replay", "run", "--model", "m.yaml", "--json", "FILE"],
        ["replay", "run", "--model", "m.yaml", "--plot", "FILE"],
        ["diagnose", "run", "--model", "m.yaml", "--out", "FILE"],
        ["diagnose", "run", "--model", "m.yaml", "--report", "FILE"],
        ["diagnose", "run", "--model", "m.yaml", "--next", "FILE"],
        ["diagnose", "run", "--model", "m.yaml", "--each", "--json", "FILE"],
        ["runs", "run", "--json", "FILE"],
        ["show", "run", "--plot", "FILE"],
        ["compare", "run", "run", "--plot", "FILE"],
        ["compare", "run", "run", "--json", "FILE"],
        ["doctor", "--bench", "bench.yaml", "--json", "FILE"],
        ["export", "run", "FILE", "--to", "csv"],
        ["sweep", "plan.yaml", "--bench", "bench.yaml", "--frame-log", "FILE"],
    ],
)
def test_an_output_is_looked_at_before_the_work(
    unread_run: Path, words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    for file, why in (
        ("run/windows.csv", "is part of the run run; name another file"),
        ("none/x", "cannot be written (No such file or directory); give a file in a folder that"),
    ):
        assert main([file if word == "FILE" else word for word in words]) == 2
        said = capsys.readouterr()
        assert said.out == ""
        assert said.err.startswith(f"usmbench: {file}: {why}")
        assert said.err.count("\n") == 1
    assert (unread_run / "windows.csv").read_text() == "measured"
    if "--json" not in words:
        assert main(["-" if word == "FILE" else word for word in words]) == 2
        assert "- is no file, standard output takes --json; name" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words", [["show", "run"], ["compare", "run", "run"], ["replay", "run", "--model", "m.yaml"]]
)
def test_a_plot_of_no_format_is_refused_before_the_work(
    unread_run: Path, words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*words, "--plot", "x.foo"]) == 2
    said = capsys.readouterr().err
    assert said == "usmbench: x.foo: its ending names no format; give a .png, .svg or .pdf\n"


def test_one_file_is_no_place_for_two_outputs(
    unread_run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["diagnose", "run", "--model", "m.yaml", "--out", "x", "--report", "x", "--json", "x"]
    assert main(words) == 2
    assert "usmbench: x: is named by --out and by --json;" in capsys.readouterr().err


def test_an_input_is_not_written_over(unread_run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("m.yaml").write_text("model")
    assert main(["diagnose", "run", "--model", "m.yaml", "--out", "m.yaml"]) == 2
    assert "m.yaml: is what this command reads; name another" in capsys.readouterr().err
