"""What the tests of commands that sweep begin with."""

from pathlib import Path

import pytest
import yaml

from tests.usmbench.cli.swept_bench import PLAN, Opened
from usmbench.cli import sweep_command


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> Opened:
    opened = Opened()
    monkeypatch.setattr(sweep_command, "open_bench", opened.open_bench)
    return opened


@pytest.fixture
def plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "plan.yaml"
    file.write_text(yaml.safe_dump(PLAN))
    return file
