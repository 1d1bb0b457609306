"""The build: the same image every time, within the chip's means."""

import re
import subprocess
from pathlib import Path

from hil_sim.gpsim_bridge import BUILD

FIRMWARE = BUILD.parent


def test_the_image_is_reproducible(tmp_path: Path) -> None:
    subprocess.run(
        ["make", "-C", FIRMWARE, "image", f"BUILD={tmp_path}"],
        check=True,
        capture_output=True,
        timeout=100,
    )
    assert (tmp_path / "generator.hex").read_bytes() == (BUILD / "generator.hex").read_bytes()


def test_flash_and_ram_leave_room() -> None:
    """A 2520 has 32 KB of flash; our variables share 128 bytes that need no bank."""
    sizes = {"program": 0, "data": 0}
    for line in (BUILD / "linked.map").read_text().splitlines():
        section = re.match(r"\s*\S+\s+(code|udata)\s+0x\w+\s+(program|data)\s+(0x\w+)", line)
        if section:
            sizes[section[2]] += int(section[3], 16)
    assert 0 < sizes["program"] < 4096
    assert 0 < sizes["data"] <= 128
