"""The small version of what the run folder costs: twenty thousand windows."""

import importlib.util
import re
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "benchmarks" / "run_folder.py"


def test_a_row_of_ours_costs_less_than_one_of_pandas(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    spec = importlib.util.spec_from_file_location("benchmark_run_folder", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    run_folder = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = run_folder
    spec.loader.exec_module(run_folder)
    run_folder.main(["--small", "--folder", str(tmp_path)])
    said = capsys.readouterr().out
    ours = re.search(r"append a window: ([\d.]+) µs", said)
    theirs = re.search(r"row by row: ([\d.]+) µs", said)
    assert ours is not None
    assert theirs is not None
    assert float(ours[1]) < float(theirs[1])
    assert "read 20000 windows" in said
