"""Draw the board: schematic.yaml becomes schematic.svg and output_stage.svg.

``python firmware/schematic.py`` writes them; with ``--check`` it writes nothing and exits 1 where a
drawing is stale.
"""

import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import yaml

from firmware.made_files import write_or_check

FOLDER = Path(__file__).resolve().parent
PITCH, STUB, BODY = 24, 34, 150
GRID, GRID_ORIGIN = 20, (60, 60)
TWO_POLE_COLUMNS, TWO_POLE_START, TWO_POLE_STEP = 2, (60, 650), (290, 42)
STYLE = """
text { font-family: sans-serif; font-size: 13px; fill: #222; }
.ref { font-weight: bold; font-size: 15px; }
.net { fill: #0b5394; }
.pin { fill: #777; font-size: 11px; }
rect, line, path { stroke: #222; stroke-width: 1.4; fill: none; }
.chip { fill: #fffbe8; }
.dot { fill: #222; stroke: none; }
.note { fill: #777; font-style: italic; }
"""

Tree = dict[str, Any]
Pin = tuple[str, str, str]


def pins(lines: list[str]) -> list[Pin | None]:
    """Read one side of a part.

    Parameters
    ----------
    lines
        One a pin, from the top: number, name, net; an empty one leaves the place empty.

    Returns
    -------
    list
        The three of each pin, None for an empty place.
    """
    return [_pin(*line.split()) if line else None for line in lines]


def _pin(number: str, name: str, net: str) -> Pin:
    return number.replace("-", ""), name, net


def net_ends(board: Tree) -> Counter[str]:
    """Count how many pins each net joins.

    Parameters
    ----------
    board
        Sheet 1 of the description.
    """
    ends: Counter[str] = Counter()
    for part in board["parts"]:
        sides = (*pins(part["left"]), *pins(part.get("right", [])))
        ends.update(pin[2] for pin in sides if pin)
    for _, first, second in board["two_poles"]:
        ends.update((first, second))
    return ends


def draw_board(board: Tree) -> str:
    """Draw sheet 1: parts with the names of their nets.

    Parameters
    ----------
    board
        Sheet 1 of the description.

    Returns
    -------
    str
        An SVG document.

    Raises
    ------
    ValueError
        A net ends nowhere.
    """
    loose = [net for net, count in net_ends(board).items() if count == 1]
    if loose:
        raise ValueError(f"these nets end nowhere: {', '.join(sorted(loose))}")
    lines = [line for part in board["parts"] for line in _draw_part(part)]
    for index, (label, first, second) in enumerate(board["two_poles"]):
        row, column = divmod(index, TWO_POLE_COLUMNS)
        x = TWO_POLE_START[0] + column * TWO_POLE_STEP[0]
        y = TWO_POLE_START[1] + row * TWO_POLE_STEP[1]
        lines += _draw_two_pole(label, (first, second), x, y)
    return _document(board, lines)


def _document(sheet: Tree, lines: list[str]) -> str:
    """Put a title over what was drawn."""
    width, height = sheet["size"]
    head = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}">',
        f"<style>{STYLE}</style>",
        f'<rect width="{width}" height="{height}" style="fill:#fff;stroke:none"/>',
        _text(30, 40, "ref", sheet["title"]),
        _text(30, 60, "note", sheet["note"]),
    ]
    return "\n".join([*head, *lines, "</svg>"]) + "\n"


def _draw_part(part: Tree) -> Iterator[str]:
    left, right = pins(part["left"]), pins(part.get("right", []))
    x, y = part["at"]
    height = PITCH * max(len(left), len(right)) + 10
    yield _text(x, y - 8, "ref", part["ref"])
    yield f'<rect class="chip" x="{x}" y="{y}" width="{BODY}" height="{height}"/>'
    for side, row in ((-1, left), (1, right)):
        for index, pin in enumerate(row):
            if pin:
                edge = x if side < 0 else x + BODY
                yield from _draw_pin(pin, edge, y + 20 + PITCH * index, side)


def _draw_pin(pin: Pin, x: int, y: int, side: int) -> Iterator[str]:
    number, name, net = pin
    outer = x + side * STUB
    inward, outward = ("start", "end") if side < 0 else ("end", "start")
    yield _line(x, y, outer, y)
    yield _text(x - side * 6, y + 5, "", name, inward)
    yield _text(x + side * 6, y - 3, "pin", number, outward)
    yield _text(outer + side * 4, y + 5, "net", net, outward)


def _draw_two_pole(label: str, nets: tuple[str, str], x: int, y: int) -> Iterator[str]:
    yield f'<rect class="chip" x="{x + 80}" y="{y}" width="56" height="14"/>'
    yield _line(x + 62, y + 7, x + 80, y + 7)
    yield _line(x + 136, y + 7, x + 154, y + 7)
    yield _text(x + 58, y + 12, "net", nets[0], "end")
    yield _text(x + 158, y + 12, "net", nets[1])
    yield _text(x + 108, y - 4, "", label, "middle")


def draw_output_stage(sheet: Tree) -> str:
    """Draw sheet 2: symbols and wires on a grid.

    Parameters
    ----------
    sheet
        Sheet 2 of the description.

    Returns
    -------
    str
        An SVG document.
    """
    return _document(sheet, [line for text in sheet["symbols"] for line in _draw_symbol(text)])


def _draw_symbol(text: str) -> Iterator[str]:
    """Draw one symbol from its line of the description."""
    kind, *words = text.split()
    points = [_point(word) for word in words if "," in word]
    label = " ".join(word for word in words if "," not in word)
    (x, y) = points[0]
    if kind in TWO_POLE_BODIES:
        yield from _draw_in_line(kind, points[0], points[1], label)
    elif kind == "wire":
        yield _path("M " + " L ".join(f"{x} {y}" for x, y in points))
    elif kind == "dot":
        yield f'<circle class="dot" cx="{x}" cy="{y}" r="3.5"/>'
    elif kind == "port":
        side, net = label.split()
        offset, anchor = (-6, "end") if side == "left" else (6, "start")
        yield _text(x + offset, y + 5, "net", net, anchor)
    else:
        for line in SHAPES[kind]:
            yield f'<path class="{line[0]}" transform="translate({x} {y})" d="{line[1]}"/>'
        dx, dy = LABEL_PLACES.get(kind, (0, 0))
        yield _text(x + dx, y + dy, "", label, "middle")


def _draw_in_line(
    kind: str, start: tuple[int, int], end: tuple[int, int], label: str
) -> Iterator[str]:
    """Draw a resistor, capacitor or coil in the middle of a wire."""
    (x1, y1), (x2, y2) = start, end
    x, y = (x1 + x2) // 2, (y1 + y2) // 2
    half, shape = TWO_POLE_BODIES[kind]
    upright = x1 == x2
    turn = 90 if upright else 0
    dx, dy = (0, half) if upright else (half, 0)
    # A wire may be given from right to left: the body's ends lie towards the wire's.
    sign = 1 if x2 + y2 > x1 + y1 else -1
    yield _line(x1, y1, x - sign * dx, y - sign * dy)
    yield _line(x + sign * dx, y + sign * dy, x2, y2)
    yield f'<path class="chip" transform="translate({x} {y}) rotate({turn})" d="{shape}"/>'
    if upright:
        reference, _, value = label.partition(" ")
        yield _text(x - 14, y - 2, "", reference, "end")
        yield _text(x - 14, y + 14, "", value, "end")
    else:
        yield _text(x, y - 14, "", label, "middle")


# Half the body's length, and its outline around the middle of a horizontal wire.
TWO_POLE_BODIES = {
    "R": (20, "M -20 -7 H 20 V 7 H -20 Z"),
    "C": (4, "M -4 -10 V 10 M 4 -10 V 10"),
    "L": (24, "M -24 0 a 6 6 0 0 1 12 0 a 6 6 0 0 1 12 0 a 6 6 0 0 1 12 0 a 6 6 0 0 1 12 0"),
}
WINDING = "c 14 0 14 20 0 20 c 14 0 14 20 0 20 c 14 0 14 20 0 20 c 14 0 14 20 0 20"
SHAPES = {
    "ground": [("", "M 0 0 V 8 M -10 8 H 10 M -6 12 H 6 M -2 16 H 2")],
    "amplifier": [
        ("chip", "M 0 -20 V 60 L 80 20 Z"),
        ("", "M 6 0 H 14 M 10 -4 V 4 M 6 40 H 14"),
    ],
    "npn": [("", "M 0 0 H 10 M 10 -16 V 16 M 10 -8 L 20 -20 V -40 M 10 8 L 20 20 V 40"),
            ("dot", "M 20 20 L 11 17 L 17 11 Z")],
    "transformer": [
        ("", f"M 0 0 {WINDING} M 26 0 V 80 M 34 0 V 80"),
        ("", f"M 60 0 {WINDING.replace('14', '-14')}"),
    ],
}  # fmt: skip
LABEL_PLACES = {"amplifier": (30, 25), "npn": (40, 5), "transformer": (30, -12)}


def _point(word: str) -> tuple[int, int]:
    column, row = word.split(",")
    return GRID_ORIGIN[0] + int(column) * GRID, GRID_ORIGIN[1] + int(row) * GRID


def _line(x1: int, y1: int, x2: int, y2: int) -> str:
    return f'<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}"/>'


def _path(outline: str) -> str:
    return f'<path d="{outline}"/>'


def _text(x: int, y: int, kind: str, text: str, anchor: str = "start") -> str:
    return f'<text x="{x}" y="{y}" class="{kind}" text-anchor="{anchor}">{escape(text)}</text>'


def main(arguments: list[str] | None = None) -> int:
    """Write the drawings, or compare with them.

    Parameters
    ----------
    arguments
        Command line without the program's name; None takes the process's own.

    Returns
    -------
    int
        Exit status: 1 where `--check` found a drawing stale.
    """
    return write_or_check(arguments, "schematic.py", "Draw the board.", _drawings)


def _drawings() -> dict[Path, str]:
    sheets = yaml.safe_load((FOLDER / "schematic.yaml").read_text("utf-8"))
    return {
        FOLDER / "schematic.svg": draw_board(sheets["board"]),
        FOLDER / "output_stage.svg": draw_output_stage(sheets["output_stage"]),
    }


if __name__ == "__main__":
    sys.exit(main())
