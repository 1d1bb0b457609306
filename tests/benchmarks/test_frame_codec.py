"""The small version of the campaign of corrupted frames, and that it would notice a bad codec."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

from usmbench.instruments.protocol import frames

SCRIPT = Path(__file__).resolve().parents[2] / "benchmarks" / "frame_codec.py"


@pytest.fixture(scope="module")
def frame_codec() -> ModuleType:
    spec = importlib.util.spec_from_file_location("benchmark_frame_codec", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_no_wrong_frame_is_accepted_beyond_what_crc_16_allows(
    frame_codec: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    assert frame_codec.main(["--small"]) == 0
    assert "corrupted frames" in capsys.readouterr().out


def test_a_codec_without_its_crc_is_noticed(
    frame_codec: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(frames, "crc_hqx", lambda data, start: 0)
    monkeypatch.setattr(frames, "crc16", lambda data: 0)
    assert frame_codec.main(["--small"]) == 1
