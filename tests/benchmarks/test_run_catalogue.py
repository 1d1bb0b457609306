"""The small version of the list's cost: five hundred runs."""

import importlib.util
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "benchmarks" / "run_catalogue.py"


def test_the_list_is_whole_and_quick(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = importlib.util.spec_from_file_location("benchmark_run_catalogue", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    run_catalogue = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = run_catalogue
    spec.loader.exec_module(run_catalogue)
    assert run_catalogue.main(["--small", "--folder", str(tmp_path)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("list: 500 runs in ")
    assert said[1].startswith("find by plan.name: 125 runs in ")
    assert "unchanged since it was written: 500 runs of 500" in said[3]
