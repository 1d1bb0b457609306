"""Every code block of the documentation is run, page by page, on the simulated bench.

Blocks tagged `sh`, `console` and `python` run in the order of their page, in a folder of its own:
one bash and one Python a page, so that variables and names last. In a `console` block, what stands
under a command is what it prints, `…` for anything. A `yaml`, `json` or `csv` block with
`title="NAME"` is written to that file first. `text` is not code. A block that cannot run here has
`<!-- not run: reason -->` on the line before it and stands in NOT_RUN.
"""

import json
import os
import re
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import yaml
from markdown_it import MarkdownIt

from usmbench.settings.bench_file import load_bench
from usmbench.settings.plan_file import load_plan

ROOT = Path(__file__).resolve().parents[2]
PAGES = ["README.md", *sorted(str(p.relative_to(ROOT)) for p in ROOT.glob("docs/**/*.md"))]
RUN = {"sh", "console", "python"}
LANGUAGES = RUN | {"yaml", "json", "csv", "text"}
BLOCK_DEADLINE_S = 240.0

# Page and reason of each block that is not run.
NOT_RUN = [
    ("docs/how-to/decide-between-causes.md", "takes runs of your own"),
    ("docs/how-to/decide-between-causes.md", "takes runs of your own"),
    ("docs/how-to/decide-between-causes.md", "takes a model of your own"),
    ("docs/how-to/decide-between-causes.md", "takes a model of your own"),
    ("docs/how-to/diagnose-many-runs.md", "takes runs of your own"),
    ("docs/how-to/diagnose-many-runs.md", "needs several machines"),
    ("docs/how-to/flash-the-board.md", "needs the flashed board"),
    ("docs/tutorial.md", "installs into a new environment"),
]

MARK = "--end of block--"
PYTHON_LOOP = f"""
import sys
names = {{"__name__": "__main__"}}
for line in sys.stdin:
    with open(line.strip(), encoding="utf-8") as file:
        exec(compile(file.read(), line.strip(), "exec"), names)
    print("{MARK}", flush=True)
"""


@dataclass(frozen=True)
class Block:
    page: str
    line: int
    language: str
    title: str | None
    text: str
    not_run: str | None = None

    @property
    def runs(self) -> bool:
        return self.language in RUN and self.not_run is None

    @property
    def where(self) -> str:
        return f"{self.page}:{self.line}"


def blocks_of(page: str, text: str) -> Iterator[Block]:
    """Give the blocks of a page, inside lists too."""
    before = ""
    for token in MarkdownIt().parse(text):
        if token.type in {"fence", "code_block"}:
            language = (token.info.split() or [""])[0]
            title = re.search(r'title="([^"]*)"', token.info)
            reason = re.search(r"<!-- not run: (.+) -->", before)
            line = token.map[0] + 1 if token.map else 0
            yield Block(
                page, line, language, title and title[1], token.content, reason and reason[1]
            )
        before = token.content if token.type == "html_block" else ""


class Interpreter:
    """A process that runs one file after another."""

    def __init__(self, command: list[str], order: str, folder: Path):
        binaries = Path(sys.executable).parent
        path = f"{binaries}{os.pathsep}{os.environ['PATH']}"
        self._order = order
        self._process = subprocess.Popen(
            command,
            cwd=folder,
            env={**os.environ, "PATH": path, "MPLBACKEND": "Agg", "PYTHONUNBUFFERED": "1"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )

    def run(self, file: Path) -> tuple[bool, str]:
        """Return whether all of the file ran, and what it printed."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(self._order.format(file=file).encode())
        self._process.stdin.flush()
        printed = b""
        deadline_s = time.monotonic() + BLOCK_DEADLINE_S
        while time.monotonic() < deadline_s:
            ready, _, _ = select.select([self._process.stdout], [], [], 0.1)
            read = os.read(self._process.stdout.fileno(), 65536) if ready else b""
            printed += read
            if printed.endswith(f"{MARK}\n".encode()):
                return True, printed.decode().removesuffix(f"{MARK}\n")
            # What it started may outlive it and hold its output open.
            if not read and self._process.poll() is not None:
                return False, f"{printed.decode()}\nexit status {self._process.returncode}"
        return False, f"{printed.decode()}\nstill running after {BLOCK_DEADLINE_S:g} s"

    def close(self) -> None:
        """End the process and whatever it started."""
        with self._process, suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)


@contextmanager
def interpreters(folder: Path) -> Iterator[dict[str, Interpreter]]:
    bash = ["bash", "--noprofile", "--norc", "-eu", "-o", "pipefail"]
    loop = [sys.executable, "-c", PYTHON_LOOP]
    shell_order = f"source '{{file}}' </dev/null\necho '{MARK}'\n"
    with ExitStack() as stack:
        shell = stack.enter_context(closing(Interpreter(bash, shell_order, folder)))
        python = stack.enter_context(closing(Interpreter(loop, "{file}\n", folder)))
        yield {"sh": shell, "console": shell, "python": python}


def transcript(text: str) -> Iterator[tuple[str, str]]:
    """Give each command of a console block and what stands under it."""
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        lines = part.splitlines(keepends=True)
        more = next((i for i, line in enumerate(lines[1:], 1) if line[:2] != "> "), len(lines))
        command = lines[0] + "".join(line[2:] for line in lines[1:more])
        yield command, "".join(lines[more:])


def matches(printed: str, expected: str) -> bool:
    """Return whether a command printed what it should; a line of `…` may stand for none."""
    pattern = "".join(
        r"(?:.*\n)?" if line == "…" else re.escape(line).replace("…", ".*") + "\n"
        for line in expected.strip().splitlines()
    )
    lines = "".join(f"{line}\n" for line in printed.strip().splitlines())
    return re.fullmatch(pattern, lines, re.DOTALL) is not None


def run_block(block: Block, started: dict[str, Interpreter], scripts: Path) -> None:
    is_console = block.language == "console"
    steps = transcript(block.text) if is_console else [(block.text, "")]
    for number, (code, expected) in enumerate(steps):
        script = scripts / f"{block.line}-{number}"
        script.write_text(code, "utf-8")
        done, printed = started[block.language].run(script)
        assert done, f"{block.where}: {code}\n{printed}"
        if is_console:
            assert matches(printed, expected), f"{block.where}: {code}\n{printed}"


def write_titled(block: Block, folder: Path) -> None:
    assert block.title is not None
    assert Path(block.title).name == block.title, f"{block.where}: a title is a bare file name"
    (folder / block.title).write_text(block.text, "utf-8")


@pytest.mark.timeout(900)  # each command has a deadline of its own
@pytest.mark.parametrize("page", PAGES)
def test_every_block_of_a_page_runs(
    page: str, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    scripts = tmp_path_factory.mktemp("blocks")
    blocks = list(blocks_of(page, (ROOT / page).read_text("utf-8")))
    if not any(block.runs for block in blocks):
        return
    with interpreters(tmp_path) as started:
        for block in blocks:
            if block.runs:
                run_block(block, started, scripts)
            elif block.title is not None:
                write_titled(block, tmp_path)


def all_blocks() -> list[Block]:
    return [b for page in PAGES for b in blocks_of(page, (ROOT / page).read_text("utf-8"))]


def test_every_block_says_its_language() -> None:
    silent = [b.where for b in all_blocks() if b.language not in LANGUAGES]
    assert [where for where in silent if where.startswith("docs/")] == []


def test_no_other_block_is_left_out() -> None:
    assert [(b.page, b.not_run) for b in all_blocks() if b.not_run is not None] == NOT_RUN


def test_every_data_block_can_be_read(tmp_path: Path) -> None:
    loaders: dict[str, Callable[[str], Any]] = {
        "usmbench-plan/1": load_plan,
        "usmbench-bench/1": load_bench,
    }
    for block in all_blocks():
        if block.language == "json":
            json.loads(block.text)
        elif block.language == "yaml":
            content = yaml.safe_load(block.text)
            kind = content.get("format") if isinstance(content, dict) else None
            if kind in loaders:
                file = tmp_path / "block.yaml"
                file.write_text(block.text, "utf-8")
                loaders[kind](str(file))


def test_a_failing_block_is_found(tmp_path: Path) -> None:
    in_list = "1. A step\n\n    ```sh\n    seen=yes\n    ```\n"
    page = f"{in_list}\n```console\n$ echo $seen\nno\n```\n"
    with interpreters(tmp_path) as started:
        first, second = blocks_of("page.md", page)
        run_block(first, started, tmp_path)
        with pytest.raises(AssertionError, match=r"(?s)page\.md:7: echo \$seen.*yes"):
            run_block(second, started, tmp_path)


@pytest.mark.parametrize(
    ("language", "code", "says"),
    [("sh", "false\necho on", "exit status 1"), ("python", "1 / 0", "ZeroDivisionError")],
)
def test_a_block_ends_at_its_first_error(
    language: str, code: str, says: str, tmp_path: Path
) -> None:
    with interpreters(tmp_path) as started:
        block = Block("page.md", 1, language, None, code)
        with pytest.raises(AssertionError, match=says):
            run_block(block, started, tmp_path)


def test_a_console_block_may_leave_out_what_changes() -> None:
    assert matches("curve 12.3 rad/s\nfine\n", "curve … rad/s\n…")
    assert matches("curve 12.3 rad/s\nfine\n", "curve … rad/s\n…\nfine\n")
    assert matches("", "")
    assert not matches("curve 12.3 rad/s\nfine\n", "curve … rad/s\n")
    assert not matches("curve 12.3 rad/s\nfine\n", "")
    assert list(transcript("$ a \\\n> b\nc\n$ d\n")) == [("a \\\nb\n", "c\n"), ("d\n", "")]
