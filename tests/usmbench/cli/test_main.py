import os
import subprocess
import sys
from pathlib import Path

import pytest

from usmbench import __version__
from usmbench.cli.main import COMMANDS, STOPPED_BY_USER, main
from usmbench.errors import BenchError, InputError


def test_the_version_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(["--version"])
    assert left.value.code == 0
    assert capsys.readouterr().out == f"usmbench {__version__}\n"


def test_the_help_says_what_the_program_does(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--help"])
    said = capsys.readouterr().out
    assert "ultrasonic motors: drive one" in said
    assert "one module a subcommand" not in said


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (["sweep", "phase-sweep", "--bench", "simulated", "--out", ""], "--out"),
        (["sweep", "phase-sweep", "--bench", "simulated", "--out="], "--out"),
        (["identify", "", "--out", "x"], "an argument"),
        (["identify", "x", "--out", "x", "--knots", ""], "--knots"),
    ],
)
def test_an_empty_argument_is_named(
    words: list[str], what: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 2
    said = capsys.readouterr().err
    assert said == f"usmbench: {what} is empty; give it a value, or leave it out\n"


@pytest.mark.parametrize("command", sorted(COMMANDS))
def test_every_command_explains_itself(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main([command, "--help"])
    assert left.value.code == 0
    assert f"usmbench {command}" in capsys.readouterr().out


@pytest.mark.parametrize(
    "words",
    [
        [],
        ["sweeep"],
        ["replay"],
        ["sweep", "--bench"],
        ["identify", "a", "--degree", "x"],
        ["runs", "--foo"],
    ],
)
def test_wrong_usage_is_one_line_and_status_2(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("usmbench: ")
    assert said.err.count("\n") == 1
    assert "--help" in said.err


class Command:
    """A subcommand whose run raises what a test wants."""

    def __init__(self, error: BaseException):
        self.error = error

    def add_arguments(self, parser: object) -> None:
        pass

    def run(self, args: object) -> int:
        raise self.error


def run_raising(error: BaseException, monkeypatch: pytest.MonkeyPatch) -> int:
    monkeypatch.setattr("importlib.import_module", lambda name: Command(error))
    return main(["demo"])


def test_a_failed_bench_is_status_3_and_its_notes_are_told(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    error = BenchError("the card is gone")
    error.add_note("switching the outputs off failed")
    assert run_raising(error, monkeypatch) == 3
    said = capsys.readouterr().err
    assert said == "usmbench: the card is gone; switching the outputs off failed\n"


def test_ctrl_c_is_status_130(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_raising(KeyboardInterrupt(), monkeypatch) == STOPPED_BY_USER
    assert "stopped by the user" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("error", "status"),
    [
        (InputError("no such run"), 2),
        (OSError("no room"), 2),
        (BenchError("the card is gone"), 3),
        (KeyboardInterrupt("hung up"), STOPPED_BY_USER),
    ],
)
def test_a_standard_error_that_is_full_does_not_change_the_status(
    error: BaseException, status: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    with open("/dev/full", "w") as full:  # noqa: PTH123 - a device
        monkeypatch.setattr("sys.stderr", full)
        assert run_raising(error, monkeypatch) == status


@pytest.mark.parametrize(
    "words", [["usmbench", "identify", "nosuch", "--out", "q"], ["hil_sim", "--defect", "none"]]
)
def test_nor_does_what_python_prints_as_it_ends(words: list[str], tmp_path: Path) -> None:
    with open("/dev/full", "w") as full:  # noqa: PTH123 - a device
        done = subprocess.run(
            [sys.executable, "-m", *words], stderr=full, cwd=tmp_path, timeout=60, check=False
        )
    assert done.returncode == 2


def test_blas_threads_are_set_before_numpy_is_there() -> None:
    code = """
import os, sys
from usmbench.cli import main
assert "numpy" not in sys.modules
main.main = lambda: int(os.environ["OPENBLAS_NUM_THREADS"])
main.entry_point()
"""
    environment = {k: v for k, v in os.environ.items() if k != "OPENBLAS_NUM_THREADS"}
    ended = subprocess.run([sys.executable, "-c", code], env=environment, check=False)
    assert ended.returncode == 1
    users = subprocess.run(
        [sys.executable, "-c", code], env={**environment, "OPENBLAS_NUM_THREADS": "7"}, check=False
    )
    assert users.returncode == 7


def _printing_to(target: str, *words: str, encoding: str = "utf-8") -> tuple[int, str]:
    with open(target, "w") as out:  # noqa: PTH123 - a device
        done = subprocess.run(
            [sys.executable, "-m", "usmbench", *words],
            stdout=out,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONIOENCODING": encoding},
            timeout=60,
        )
    return done.returncode, done.stderr


@pytest.mark.parametrize("closed", [">&-", "2>&-", ">&- 2>&-", "<&- >&- 2>&-"])
def test_an_output_that_is_closed_is_no_error(closed: str, tmp_path: Path) -> None:
    words = [sys.executable, "-m", "usmbench", "runs", str(tmp_path), "--json"]
    for target in ("-", str(tmp_path / "runs.json")):
        done = subprocess.run(
            ["sh", "-c", f'exec "$@" {closed}', "sh", *words, target],
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0
        assert done.stderr == ""
    assert (tmp_path / "runs.json").read_text() == '{\n  "runs": []\n}\n'


def test_an_output_that_is_full_is_one_line() -> None:
    status, said = _printing_to("/dev/full", "sweep", "phase-sweep", "--dry-run")
    assert status == 2
    assert said == "usmbench: standard output: No space left on device; look at it\n"


def test_an_output_that_lacks_letters_gets_question_marks(tmp_path: Path) -> None:
    out = tmp_path / "out.txt"
    status, said = _printing_to(str(out), "sweep", "phase-sweep", "--dry-run", encoding="ascii")
    assert (status, said) == (0, "")
    assert b"-90? " in out.read_bytes()
