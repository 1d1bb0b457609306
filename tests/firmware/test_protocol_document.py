"""The examples of PROTOCOL.md are what the codec makes of them."""

import re
from pathlib import Path

import pytest

from usmbench.instruments.protocol import _generated
from usmbench.instruments.protocol.frames import FrameReader, crc16, encode_frame
from usmbench.instruments.protocol.messages import describe

DOCUMENT = (Path(__file__).resolve().parents[2] / "firmware" / "PROTOCOL.md").read_text("utf-8")
SESSION = re.findall(r"^    [<>] ((?:[0-9A-F]{2} ?)+)\n((?:        .*\n)+)", DOCUMENT, re.M)


def test_the_document_has_a_whole_session() -> None:
    assert len(SESSION) == 14


@pytest.mark.parametrize(("line", "meaning"), SESSION)
def test_an_example_frame_means_what_the_document_says(line: str, meaning: str) -> None:
    [frame] = FrameReader().feed(bytes.fromhex(line))
    assert describe(frame) == " ".join(meaning.split())
    assert encode_frame(*frame).hex(" ").upper() == line


def test_the_frame_taken_apart_byte_by_byte() -> None:
    body = bytes.fromhex("04 03 00 FC F2 39")
    assert body.hex(" ").upper() in DOCUMENT
    assert crc16(body[:4]) == 0x39F2
    encoded = encode_frame(body[0], body[1], body[2:4]).hex(" ").upper()
    assert f"    {encoded}\n" in DOCUMENT
    assert int.from_bytes(body[2:4], "little", signed=True) == -1024


def test_every_refusal_and_fault_is_explained() -> None:
    names = [
        member.name.lower()
        for group in (_generated.Refusal, _generated.Flags, _generated.Faults)
        for member in group
        if member.name is not None
    ]
    assert [name for name in names if name not in DOCUMENT] == []
