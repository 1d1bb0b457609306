"""What may never end is not read."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from usmbench.errors import InputError
from usmbench.runs.reader import read_run
from usmbench.settings.regular_file import refuse_endless
from usmbench.settings.yaml_source import read_source


@pytest.mark.parametrize("read", [read_run, read_source, refuse_endless])
def test_a_pipe_without_a_writer_is_refused_at_once(
    read: Callable[[Path], Any], tmp_path: Path
) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with pytest.raises(InputError, match="pipe: is a pipe or a device"):
        read(pipe)


def test_files_folders_and_what_is_not_there_may_be_asked_for(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("")
    for path in (file, tmp_path, tmp_path / "none", tmp_path / ("x" * 300), Path("a\0b")):
        refuse_endless(path)
