"""No output may cost what was measured, and none fails after the work that it was to keep."""

import errno
import tempfile
from pathlib import Path

import pytest

from usmbench.errors import InputError
from usmbench.runs.output_paths import check_outputs
from usmbench.runs.reader import read_run


@pytest.mark.parametrize("name", ["run.yaml", "windows.csv", "pairs.csv", "raw.h5"])
@pytest.mark.parametrize("folder", ["run", "run/../run", "link"])
def test_a_file_of_a_run_is_refused(unread_run: Path, folder: str, name: str) -> None:
    Path("link").symlink_to(unread_run)
    with pytest.raises(InputError, match=f"{name}: is part of the run {folder}; name another file"):
        check_outputs({"--json": f"{folder}/{name}"})


def test_what_is_read_is_not_written(unread_run: Path) -> None:
    bare = Path("bare.csv")
    bare.write_text("measured")
    bare.with_name("link.csv").symlink_to(bare)
    bare.with_name("hard.csv").hardlink_to(bare)
    for name in ("bare.csv", "link.csv", "hard.csv"):
        with pytest.raises(InputError, match=f"{name}: is what this command reads; name another"):
            check_outputs({"--out": Path(name)}, [unread_run, None, bare])


def test_a_file_takes_one_output(unread_run: Path) -> None:
    with pytest.raises(InputError, match=r"x: is named by --out and by --json; name a file for"):
        check_outputs({"--out": Path("x"), "--report": None, "--json": "run/../x"})


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("none/x", r"none/x: cannot be written .*; give a file in a folder that exists"),
        ("run", r"run: cannot be written .*; it is a folder; name a file"),
        ("run/windows.csv/x", r"cannot be written .*Not a directory.*"),
        ("loop", r"loop: cannot be written .*; it is a link that leads back to itself; name ano"),
        ("loop/x", r"loop/x: cannot be written .*; it is a link that leads back to itself; name"),
        ("x" * 300, r"cannot be written .*; give a shorter name"),
    ],
)
def test_what_cannot_be_written_is_told_before_the_work(
    unread_run: Path, name: str, message: str
) -> None:
    Path("loop").symlink_to("loop")
    with pytest.raises(InputError, match=message):
        check_outputs({"--out": name})


def test_a_link_that_leads_back_to_itself_is_refused_by_who_reads_it(unread_run: Path) -> None:
    loop = Path("loop")
    loop.symlink_to(loop)
    check_outputs({"--json": "x"}, [loop])
    with pytest.raises(InputError, match=r"loop: cannot be read: .* links; name a run folder"):
        read_run(loop)


def test_a_folder_that_takes_no_file_is_told(
    unread_run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(dir: Path) -> None:  # noqa: A002 - its name there
        raise OSError(errno.EROFS, "Read-only file system", str(dir))

    monkeypatch.setattr(tempfile, "TemporaryFile", refuse)
    with pytest.raises(InputError, match=r"x: cannot be written \(Read-only.*where you may write"):
        check_outputs({"--out": "x"})


def test_what_costs_nothing_is_taken(unread_run: Path) -> None:
    Path("old.yaml").write_text("an older model")
    Path("windows.csv").write_text("of no run")
    names = ["old.yaml", "windows.csv", "run/model.yaml", "/dev/null", None]
    check_outputs(
        {f"--{number}": name for number, name in enumerate(names)}, [unread_run, "phase-sweep"]
    )
    check_outputs({"--json": "/dev/null", "--report": "/dev/null"})
    check_outputs({"--json": "-"})
    assert sorted(entry.name for entry in unread_run.iterdir()) == [
        "pairs.csv",
        "run.yaml",
        "windows.csv",
    ]
