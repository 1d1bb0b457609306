"""The drawings and tables of BOARD.md are what the scripts make, and can be read."""

import itertools
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
import yaml

FIRMWARE = Path(__file__).resolve().parents[2] / "firmware"
DOCUMENT = (FIRMWARE / "BOARD.md").read_text("utf-8")
BOARD = yaml.safe_load((FIRMWARE / "schematic.yaml").read_text("utf-8"))["board"]
# A letter's width and the height of a line, in parts of the size of the type.
LETTER_WIDTH, LINE_HEIGHT = 0.58, 0.8
TYPE_SIZES = {"ref": 15, "pin": 11}


class Box:
    """Where a text stands."""

    def __init__(self, element: ET.Element):
        self.text = element.text or ""
        size = TYPE_SIZES.get(element.get("class", ""), 13)
        width = LETTER_WIDTH * size * len(self.text)
        share = {"start": 0.0, "middle": 0.5, "end": 1.0}[element.get("text-anchor", "start")]
        self.left = float(element.get("x", "")) - share * width
        self.right = self.left + width
        self.bottom = float(element.get("y", ""))
        self.top = self.bottom - LINE_HEIGHT * size

    def overlaps(self, other: "Box") -> bool:
        return (
            self.left < other.right
            and other.left < self.right
            and self.top < other.bottom
            and other.top < self.bottom
        )


def test_the_drawings_are_what_the_description_makes() -> None:
    script = FIRMWARE / "schematic.py"
    done = subprocess.run([sys.executable, script, "--check"], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("name", ["schematic.svg", "output_stage.svg"])
def test_no_text_covers_another_or_leaves_the_page(name: str) -> None:
    root = ET.parse(FIRMWARE / name).getroot()
    _, _, width, height = map(float, root.get("viewBox", "").split())
    boxes = [Box(element) for element in root.iter("{http://www.w3.org/2000/svg}text")]
    assert len(boxes) > 15
    assert [box.text for box in boxes if box.left < 0 or box.right > width] == []
    assert [box.text for box in boxes if box.top < 0 or box.bottom > height] == []
    covered = [(a.text, b.text) for a, b in itertools.combinations(boxes, 2) if a.overlaps(b)]
    assert covered == []


def test_the_pin_table_is_the_schematic() -> None:
    (processor,) = [part for part in BOARD["parts"] if "PIC18F2520" in part["ref"]]
    drawn: dict[int, tuple[str, str]] = {}
    for line in (*processor["left"], *processor["right"]):
        if line:
            numbers, name, net = line.split()
            drawn |= {int(number): (name.split("/")[0], net) for number in numbers.split(",")}
    rows = re.findall(r"^\| (\d+) \| (R[BC]\d) \| (\S+)", DOCUMENT, re.M)
    assert len(rows) == 9
    for number, name, use in rows:
        assert drawn[int(number)][0] == name
        if use.rstrip(",") in {"SCLK", "TX", "RX", "SYNC", "ENABLE", "SDATA"}:
            assert drawn[int(number)][1].startswith(use.rstrip(","))


def test_the_phase_budget_is_what_the_script_prints() -> None:
    done = subprocess.run(
        [sys.executable, FIRMWARE / "phase_budget.py"], capture_output=True, text=True, check=True
    )
    table, prose = done.stdout.split("\n\n")
    assert table in DOCUMENT
    flowing = " ".join(DOCUMENT.split())
    for figure in re.findall(r"\d+(?:\.\d+)? (?:%|V rms|V peak)|\d+° behind", prose):
        assert figure in flowing
