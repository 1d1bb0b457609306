"""Runs are found wherever they lie, by whatever their run.yaml says."""

import errno
import io
import os
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from usmbench.errors import InputError
from usmbench.runs import meta, meta_blocks
from usmbench.runs.catalogue import changed_data, find_runs
from usmbench.runs.condition import parse_condition

RUN = """\
format: usmbench-run/1
id: {name}
started: '2026-11-{day:02d}T10:00:00+01:00'
bench:
  temperature: null
  generator: {{port: /dev/ttyUSB0}}
plan:
  name: {plan}
  frequency_hz: [41000, 41500]
  torque_nm: 0.1
simulated: true
exit: {exit}
"""


def make(folder: Path, day: int, *, plan: str = "phase-sweep", outcome: str = "completed") -> Path:
    folder.mkdir(parents=True)
    text = RUN.format(name=folder.name, day=day, plan=plan, exit=f"'{outcome}'")
    (folder / "run.yaml").write_text(text)
    return folder


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    make(tmp_path / "b", 2, plan="telegraph")
    make(tmp_path / "2026" / "a", 1)
    make(tmp_path / "2026" / "deep" / "c", 3, outcome="failed: the card gave no data")
    (tmp_path / "2026" / "notes").mkdir()
    return tmp_path


def ids(folder: Path, *conditions: str) -> list[str | None]:
    found = find_runs(folder, [parse_condition(text) for text in conditions])
    return [run.run_id for run in found.runs]


def test_the_oldest_comes_first(runs: Path) -> None:
    assert ids(runs) == ["a", "b", "c"]


def test_a_summary_says_when_what_and_how_it_ended(runs: Path) -> None:
    (run,) = find_runs(runs, [parse_condition("id=c")]).runs
    assert run.folder == runs / "2026" / "deep" / "c"
    assert run.started is not None
    assert run.started.isoformat() == "2026-11-03T10:00:00+01:00"
    assert (run.plan, run.frequencies_hz, run.torques_nm) == (
        "phase-sweep",
        (41000.0, 41500.0),
        (0.1,),
    )
    assert run.exit_text == "failed: the card gave no data"


@pytest.mark.parametrize(
    ("conditions", "expected"),
    [
        (["plan.name=telegraph"], ["b"]),
        (["plan.frequency_hz=41.5e3"], ["a", "b", "c"]),
        (["plan.frequency_hz=41"], []),
        (["plan.torque_nm=0.10"], ["a", "b", "c"]),
        (["exit=FAILED*"], ["c"]),
        (["exit=failed"], []),
        (["plan.name=phase*", "exit=completed"], ["a"]),
        (["bench.generator.port=*USB?"], ["a", "b", "c"]),
        (["started=2026-11-02*"], ["b"]),
        (["bench.temperature.channel=ai0"], []),
        (["nothing=1"], []),
        (["simulated=true"], ["a", "b", "c"]),
        (["simulated=1"], []),
        (["simulated=["], []),
    ],
)
def test_any_key_finds(runs: Path, conditions: list[str], expected: list[str]) -> None:
    assert ids(runs, *conditions) == expected


@pytest.mark.parametrize("text", ["", "plan.name", "=phase-sweep"])
def test_what_is_no_condition_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="KEY=VALUE"):
        parse_condition(text)


def test_a_run_folder_is_a_list_of_one(runs: Path) -> None:
    assert ids(runs / "b") == ["b"]


def test_one_bad_run_does_not_hide_the_others(runs: Path) -> None:
    (runs / "b" / "run.yaml").write_text("format: something/else\n")
    found = find_runs(runs)
    assert [run.run_id for run in found.runs] == ["a", "c"]
    assert len(found.unreadable) == 1
    assert "b/run.yaml" in found.unreadable[0]


def test_a_bare_run_is_listed_with_what_it_has(tmp_path: Path) -> None:
    (tmp_path / "run.yaml").write_text("format: usmbench-run/1\nplan: 3\nstarted: [1]\nexit: 4\n")
    (run,) = find_runs(tmp_path).runs
    assert (run.started, run.plan, run.frequencies_hz, run.exit_text) == (None, None, (), "4")


@pytest.mark.parametrize(
    "odd",
    [
        "plan: {frequency_hz: .nan, torque_nm: [.inf, -.inf]}",
        f"plan: {{frequency_hz: {'9' * 400}, torque_nm: []}}",
        "started: 0001-01-01T00:00:00",
        "started: '0001-01-01T00:00:00'",
    ],
)
def test_what_no_bench_has_measured_is_not_said(runs: Path, odd: str) -> None:
    (runs / "b" / "run.yaml").write_text(f"format: usmbench-run/1\nid: b\n{odd}\n")
    found = find_runs(runs)
    run = next(run for run in found.runs if run.run_id == "b")
    assert (run.started, run.frequencies_hz) == (None, ())
    assert len(found.runs) == 3


def pipe(place: Path) -> None:
    os.mkfifo(place)


def endless(place: Path) -> None:
    place.symlink_to("/dev/zero")


@pytest.mark.parametrize("lay", [pipe, endless])
def test_a_run_yaml_without_an_end_does_not_hide_the_others(
    runs: Path, lay: Callable[[Path], None]
) -> None:
    (runs / "b" / "run.yaml").unlink()
    lay(runs / "b" / "run.yaml")
    found = find_runs(runs)
    assert [run.run_id for run in found.runs] == ["a", "c"]
    assert "b/run.yaml: is a pipe or a device" in found.unreadable[0]


def test_a_run_yaml_that_is_too_long_is_not_read_whole(
    runs: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in (meta, meta_blocks):
        monkeypatch.setattr(module, "MOST_BYTES", 1000)
    with (runs / "b" / "run.yaml").open("a") as file:
        file.write("note: " + 1000 * "x" + "\n")
    found = find_runs(runs)
    assert [run.run_id for run in found.runs] == ["a", "c"]
    assert "b/run.yaml: is longer than 1000 bytes" in found.unreadable[0]


@pytest.mark.parametrize("name", ["windows.csv", "pairs.csv"])
def test_data_that_is_a_pipe_cannot_be_checked(make_run: Callable[..., Path], name: str) -> None:
    folder = make_run()
    (folder / name).unlink()
    pipe(folder / name)
    with pytest.raises(InputError, match=f"{name}: is a pipe or a device"):
        changed_data(folder)


def test_links_are_left_alone(runs: Path) -> None:
    (runs / "again").symlink_to(runs / "2026", target_is_directory=True)
    (runs / "2026" / "round").symlink_to(runs, target_is_directory=True)
    assert ids(runs) == ["a", "b", "c"]


def test_a_folder_that_is_none_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is no folder"):
        find_runs(tmp_path / "none")


def refuse(monkeypatch: pytest.MonkeyPatch, module: ModuleType, name: str, refused: Path) -> None:
    """Let a function of the system refuse one path, as it does to others than root."""
    whole = getattr(module, name)

    def asked(path: object, *more: object, **others: object) -> object:
        if str(path) == str(refused):
            raise PermissionError(errno.EACCES, "Permission denied", str(path))
        return whole(path, *more, **others)

    monkeypatch.setattr(module, name, asked)


def test_a_folder_that_is_closed_to_us_does_not_hide_the_others(
    runs: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (runs / "lost+found").mkdir()
    refuse(monkeypatch, os, "scandir", runs / "lost+found")
    found = find_runs(runs)
    assert [run.run_id for run in found.runs] == ["a", "b", "c"]
    assert found.unreadable == (
        f"{runs}/lost+found: cannot be searched: Permission denied; make it readable",
    )
    with pytest.raises(InputError, match=r"lost\+found: cannot be searched: Permission denied"):
        find_runs(runs / "lost+found")


def test_data_that_cannot_be_read_has_not_changed(
    make_run: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = make_run()
    refuse(monkeypatch, io, "open", folder / "windows.csv")
    with pytest.raises(InputError, match=r"windows.csv: cannot be read: Permission denied"):
        changed_data(folder)


def test_changed_and_missing_data_is_seen(make_run: Callable[..., Path]) -> None:
    folder = make_run()
    assert changed_data(folder) == []
    with (folder / "windows.csv").open("a") as file:
        file.write("9,0,0,0,0,0,0.01,0,0,0,0,0\n")
    (folder / "pairs.csv").unlink()
    assert changed_data(folder) == ["windows.csv", "pairs.csv"]


@pytest.mark.parametrize("name", ["../secret", "/etc/hostname", "sub/../../x", "", "a/b"])
def test_no_file_outside_the_folder_is_touched(tmp_path: Path, name: str) -> None:
    (tmp_path / "run.yaml").write_text(f"format: usmbench-run/1\nsha256: {{{name!r}: abc}}\n")
    with pytest.raises(InputError, match="not a file of this folder"):
        changed_data(tmp_path)


def test_a_link_out_of_the_folder_is_not_followed(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    (tmp_path / "secret").write_text("x")
    (folder / "windows.csv").symlink_to(tmp_path / "secret")
    (folder / "run.yaml").write_text("format: usmbench-run/1\nsha256: {windows.csv: abc}\n")
    with pytest.raises(InputError, match="not a file of this folder"):
        changed_data(folder)


def test_a_run_that_was_never_closed_has_nothing_to_hold_it_to(tmp_path: Path) -> None:
    (tmp_path / "run.yaml").write_text("format: usmbench-run/1\n")
    assert changed_data(tmp_path) == []
