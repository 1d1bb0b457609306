"""Settled pairs of a run: read, or derived from its windows."""

from collections.abc import Callable
from pathlib import Path

import pytest

from usmbench.errors import InputError
from usmbench.runs.reader import read_run


def test_pairs_are_derived_where_they_are_missing(make_run: Callable[..., Path]) -> None:
    folder = make_run(4)
    measured = read_run(folder).pairs
    (folder / "pairs.csv").unlink()
    derived = read_run(folder).pairs
    assert measured is not None
    assert derived is not None
    for name in ("phase_deg", "frequency_hz", "torque_nm", "n_windows", "direction", "t_s"):
        assert getattr(derived, name) == pytest.approx(getattr(measured, name))
    assert derived.speed_rad_s == pytest.approx(measured.speed_rad_s, abs=2e-3)


@pytest.mark.parametrize(
    ("column", "value"), [("n_windows", -3), ("direction", 5), ("speed_std_rad_s", -0.5)]
)
def test_pairs_that_cannot_be_are_named(
    make_run: Callable[..., Path], column: str, value: float
) -> None:
    file = make_run() / "pairs.csv"
    lines = [line.split(",") for line in file.read_text().splitlines()]
    lines[2][lines[0].index(column)] = str(value)
    file.write_text("".join(",".join(line) + "\n" for line in lines))
    with pytest.raises(InputError, match=rf"pairs.csv:3: {column} is {value}, not .* to .*; mend"):
        read_run(file.parent)


@pytest.mark.parametrize("torn", ["", "phase_deg,fre", "phase_deg\0\0", "\0"])
def test_pairs_that_were_cut_before_their_first_row_are_derived(
    make_run: Callable[..., Path], torn: str
) -> None:
    folder = make_run(outcome="interrupted")
    (folder / "pairs.csv").write_text(torn)
    pairs = read_run(folder).pairs
    assert pairs is not None
    assert pairs.phase_deg.tolist() == [0.0, 5.0, 10.0]
