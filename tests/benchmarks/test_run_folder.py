"""The small version of what the run folder costs: twenty thousand windows."""

import re
from pathlib import Path

import pytest

from benchmarks import run_folder


def test_a_row_of_ours_costs_less_than_one_of_pandas(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run_folder.main(["--small", "--folder", str(tmp_path)])
    said = capsys.readouterr().out
    ours = re.search(r"append a window: ([\d.]+) µs", said)
    theirs = re.search(r"row by row: ([\d.]+) µs", said)
    assert ours is not None
    assert theirs is not None
    assert float(ours[1]) < float(theirs[1])
    assert "read 20000 windows" in said
