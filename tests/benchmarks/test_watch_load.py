"""The small version of the live page's cost: eight seconds of a run."""

import importlib.util
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "benchmarks" / "watch_load.py"


def test_the_live_page_costs_little(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    spec = importlib.util.spec_from_file_location("benchmark_watch_load", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    watch_load = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = watch_load
    spec.loader.exec_module(watch_load)
    monkeypatch.setattr(sys, "argv", ["watch_load.py", "--small"])
    assert watch_load.main() == 0
    assert "of a core" in capsys.readouterr().out
