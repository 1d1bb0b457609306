"""The small version of the campaign of corrupted frames, and that it would notice a bad codec."""

import pytest

from benchmarks import frame_codec
from usmbench.instruments.protocol import frames


def test_no_wrong_frame_is_accepted_beyond_what_crc_16_allows(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert frame_codec.main(["--small"]) == 0
    assert "corrupted frames" in capsys.readouterr().out


def test_a_codec_without_its_crc_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(frames, "crc_hqx", lambda data, start: 0)
    monkeypatch.setattr(frames, "crc16", lambda data: 0)
    assert frame_codec.main(["--small"]) == 1
