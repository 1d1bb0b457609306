"""The small version of the list's cost: five hundred runs."""

from pathlib import Path

import pytest

from benchmarks import run_catalogue


def test_the_list_is_whole_and_quick(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_catalogue.main(["--small", "--folder", str(tmp_path)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("list: 500 runs in ")
    assert said[1].startswith("find by plan.name: 125 runs in ")
    assert "unchanged since it was written: 500 runs of 500" in said[3]
