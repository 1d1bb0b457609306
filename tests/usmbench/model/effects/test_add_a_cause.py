"""The guide's example, installed as a user's package would be, is found, kept and simulated."""

import re
import sys
from collections.abc import Iterator
from importlib import invalidate_caches
from pathlib import Path

import numpy as np
import pytest

from usmbench.errors import InputError
from usmbench.model.effects.context import Context
from usmbench.model.effects.registry import find_effect, library
from usmbench.model.extended import Applied, applied_effects, extended_run
from usmbench.model.hammerstein import LinearPart

GUIDE = Path(__file__).parents[4] / "docs" / "how-to" / "add-a-cause.md"


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Install the guide's example; yield its file."""
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


@pytest.mark.usefixtures("installed")
def test_the_example_is_found_kept_and_simulated() -> None:
    effect = find_effect("brake_left_on", "")
    applied = Applied(effect, {"slowed_by": 0.5, "until_s": 0.105})
    assert applied_effects([applied.to_mapping()]) == (applied,)
    linear = LinearPart(np.empty(0), np.array([1.0]), 0, 0.01)
    context = Context(0.01 * np.arange(1.0, 21.0), 0.01, np.full(20, 8.0), lambda p: p, linear)
    speed = extended_run([applied], context).speed_rad_s
    assert np.allclose(speed, np.r_[np.full(10, 4.0), np.full(10, 8.0)])
    assert effect.grid([context])["until_s"].size == 19


@pytest.mark.parametrize("broken", ["import nowhere_at_all", "nothing_here", "1 / 0", "def ("])
def test_a_file_that_fails_is_told_with_its_cause(installed: Path, broken: str) -> None:
    installed.write_text(broken, "utf-8")
    with pytest.raises(InputError, match=r"brake_left_on .* cannot be loaded: \w+Error: .*package"):
        library()
