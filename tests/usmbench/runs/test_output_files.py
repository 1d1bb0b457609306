"""What a command writes is whole, or what was there stays."""

import os
import resource
from pathlib import Path

import pytest

from usmbench.errors import InputError
from usmbench.runs.output_files import write_output


def test_an_old_file_stays_where_the_new_one_does_not_fit(tmp_path: Path) -> None:
    path = tmp_path / "model.yaml"
    write_output(path, "old")
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limit[1]))
    try:
        with pytest.raises(InputError, match=r"model.yaml: cannot be written .*raise the limit"):
            write_output(path, "x" * 5000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["model.yaml"]


@pytest.mark.parametrize(
    ("name", "mend"), [(".", "it is a folder; name a file"), ("no/where", "a folder that exists")]
)
def test_what_cannot_be_written_is_told_with_its_mend(tmp_path: Path, name: str, mend: str) -> None:
    with pytest.raises(InputError, match=mend):
        write_output(tmp_path / name, b"")


def test_a_link_that_leads_back_to_itself_is_left_alone(tmp_path: Path) -> None:
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    with pytest.raises(InputError, match=r"loop: cannot be written .*leads back to itself; name"):
        write_output(loop, "text")
    assert loop.is_symlink()


def test_a_link_stays_a_link_and_a_pipe_a_pipe(tmp_path: Path) -> None:
    link, real = tmp_path / "link", tmp_path / "real"
    link.symlink_to(real)
    write_output(link, "text")
    assert link.is_symlink()
    assert real.read_text() == "text"
    reader, writer = os.pipe()
    write_output(Path(f"/dev/fd/{writer}"), "text")
    assert os.read(reader, 10) == b"text"
    os.close(reader)
    os.close(writer)
