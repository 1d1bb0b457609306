"""Where a run stopped, from files that a power cut or a hand has damaged."""

from collections.abc import Callable
from pathlib import Path

import pytest

from usmbench.errors import InputError
from usmbench.runs.stop_point import stop_point
from usmbench.runs.writer import RunWriter

LOST = r"windows\.csv: ends at 0 s, pairs\.csv at 0\.3 s: windows are missing; put the file back"


def content(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in folder.iterdir()}


def cut(file: Path, lines: int) -> None:
    file.write_bytes(b"".join(file.read_bytes().splitlines(keepends=True)[:lines]))


def remove(file: Path) -> None:
    file.unlink()


def empty(file: Path) -> None:
    file.write_bytes(b"")


def fill_with_zeros(file: Path) -> None:
    file.write_bytes(bytes(file.stat().st_size))


def leave_the_head(file: Path) -> None:
    cut(file, 1)


@pytest.mark.parametrize("damage", [remove, empty, fill_with_zeros, leave_the_head])
def test_pairs_whose_windows_are_lost_are_not_gone_on_with(
    make_run: Callable[..., Path], damage: Callable[[Path], None]
) -> None:
    folder = make_run(outcome="interrupted")
    damage(folder / "windows.csv")
    before = content(folder)
    with pytest.raises(InputError, match=LOST):
        RunWriter.resume(folder)
    assert content(folder) == before


def test_windows_that_end_before_the_last_pair_are_not_gone_on_with(
    make_run: Callable[..., Path],
) -> None:
    folder = make_run(outcome="interrupted")
    cut(folder / "windows.csv", 26)
    with pytest.raises(InputError, match=r"windows\.csv: ends at 0\.25 s.*remove the pairs"):
        RunWriter.resume(folder)
    cut(folder / "pairs.csv", 3)
    assert RunWriter.resume(folder).stopped_at.last_dwell == 1


@pytest.mark.parametrize("name", ["windows.csv", "pairs.csv"])
@pytest.mark.parametrize("value", ["nan", "inf", "", "0.31x"])
def test_a_last_row_that_no_sweep_wrote_is_named(
    make_run: Callable[..., Path], name: str, value: str
) -> None:
    folder = make_run(outcome="interrupted")
    *_, last = (folder / name).read_text().splitlines()
    with (folder / name).open("a") as file:
        print(*[value] * (last.count(",") + 1), sep=",", file=file)
    before = content(folder)
    line = before[name].count(b"\n")
    with pytest.raises(InputError, match=rf"{name}:{line}: the last row .* remove it"):
        RunWriter.resume(folder)
    assert content(folder) == before


def test_a_torn_row_and_zeros_behind_the_last_row_are_passed_over(
    make_run: Callable[..., Path],
) -> None:
    folder = make_run(outcome="interrupted")
    with (folder / "windows.csv").open("ab") as file:
        file.write(b"0.31,15," + bytes(10_000))
    stopped = stop_point(folder)
    assert stopped.last_dwell == 2
    assert stopped.t_s == pytest.approx(0.3)
    assert RunWriter.resume(folder).stopped_at == stopped
