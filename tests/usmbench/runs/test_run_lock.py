"""One program at a time writes a run."""

import os
import signal
import subprocess
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from usmbench.errors import BenchError, InputError
from usmbench.runs.run_lock import check_free
from usmbench.runs.writer import RunWriter

pytest.importorskip("fcntl")

HOLDS = textwrap.dedent(
    """
    import sys
    from pathlib import Path
    from usmbench.runs.writer import RunWriter
    writer = RunWriter.resume(Path(sys.argv[1]))
    print("taken up", flush=True)
    sys.stdin.read()
    """
)


def content(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in folder.iterdir()}


def test_a_run_that_is_written_is_not_taken_up_and_stays_as_it_is(
    tmp_path: Path, meta: dict[str, Any], fill: Callable[[RunWriter, int, int], None]
) -> None:
    folder = tmp_path / "run"
    writer = RunWriter.create(folder, meta, temperature=True, raw=True)
    fill(writer, 0, 2)
    before = content(folder)
    with pytest.raises(InputError, match="another program writes this run"):
        RunWriter.resume(folder)
    with pytest.raises(InputError, match="another program writes this run"):
        check_free(folder)
    assert content(folder) == before
    writer.close("interrupted")
    check_free(folder)
    RunWriter.resume(folder).close("completed")


def test_of_two_that_take_up_a_run_one_does_and_a_kill_sets_it_free(
    make_run: Callable[..., Path],
) -> None:
    folder = make_run(outcome="interrupted")
    command = [sys.executable, "-c", HOLDS, str(folder)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as first:
        assert first.stdout is not None
        assert first.stdout.readline() == b"taken up\n"
        with pytest.raises(InputError, match="another program writes this run"):
            RunWriter.resume(folder)
        os.kill(first.pid, signal.SIGKILL)
        first.wait(10.0)
    RunWriter.resume(folder).close("completed")


def test_a_resume_that_is_refused_sets_the_run_free(make_run: Callable[..., Path]) -> None:
    folder = make_run(outcome="interrupted")
    (folder / "raw.h5").write_bytes(b"no HDF5")
    for _ in range(2):
        with pytest.raises(BenchError, match=r"raw\.h5"):
            RunWriter.resume(folder)
    (folder / "raw.h5").unlink()
    RunWriter.resume(folder).close("completed")


def test_a_run_without_windows_is_free(tmp_path: Path) -> None:
    check_free(tmp_path)
    assert list(tmp_path.iterdir()) == []
