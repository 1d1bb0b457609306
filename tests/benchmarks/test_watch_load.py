"""The small version of the live page's cost: eight seconds of a run."""

import sys

import pytest

from benchmarks import watch_load


def test_the_live_page_costs_little(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["watch_load.py", "--small"])
    assert watch_load.main() == 0
    assert "of a core" in capsys.readouterr().out
