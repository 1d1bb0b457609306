"""What tests of several packages start from."""

from pathlib import Path

import pytest


@pytest.fixture
def unread_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a run that no command can read, below the folder that a command is started in."""
    monkeypatch.chdir(tmp_path)
    folder = Path("run")
    folder.mkdir()
    for name in ("run.yaml", "windows.csv", "pairs.csv"):
        (folder / name).write_text("measured")
    return folder
