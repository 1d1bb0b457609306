"""What tests of several packages start from."""

import re
import sys
from collections.abc import Iterator
from importlib import invalidate_caches
from pathlib import Path

import pytest

from usmbench.model.effects.registry import library

GUIDE = Path(__file__).parents[2] / "docs" / "how-to" / "add-a-cause.md"


@pytest.fixture
def unread_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a run that no command can read, below the folder that a command is started in."""
    monkeypatch.chdir(tmp_path)
    folder = Path("run")
    folder.mkdir()
    for name in ("run.yaml", "windows.csv", "pairs.csv"):
        (folder / name).write_text("measured")
    return folder


@pytest.fixture
def users_cause(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Install the guide's example as a user's package would be; yield its file."""
    example = re.search(r"```python\n(.*?)```", GUIDE.read_text("utf-8"), re.DOTALL)
    registered = re.search(r"```text\n(.*?)```", GUIDE.read_text("utf-8"), re.DOTALL)
    assert example is not None
    assert registered is not None
    assert len(example[1].splitlines()) <= 35
    package, info = tmp_path / "my_bench", tmp_path / "my_bench-1.0.dist-info"
    package.mkdir()
    (package / "__init__.py").write_text("", "utf-8")
    (package / "brake_left_on.py").write_text(example[1], "utf-8")
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: my-bench\nVersion: 1.0\n", "utf-8")
    section, line = registered[1].strip().splitlines()
    group = section.removeprefix('[project.entry-points."').removesuffix('"]')
    (info / "entry_points.txt").write_text(f"[{group}]\n{line.replace(chr(34), '')}\n", "utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    for name in ("my_bench", "my_bench.brake_left_on"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    invalidate_caches()
    library.cache_clear()
    yield package / "brake_left_on.py"
    library.cache_clear()
