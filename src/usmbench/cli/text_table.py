"""Lines for a terminal: columns under their heads, and nothing in them that moves the cursor."""

from collections.abc import Sequence


def printable(text: str) -> str:
    """Return text with `�` for what a terminal would obey instead of show.

    Parameters
    ----------
    text
        Such as a name from a file that somebody else wrote.
    """
    return "".join(letter if letter.isprintable() else "�" for letter in text)


def text_table(heads: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return cells in columns, under their heads.

    Parameters
    ----------
    heads
        Names of the columns.
    lines
        The cells of each line, as many as there are heads.
    """
    rows = [[printable(cell) for cell in row] for row in (heads, *lines)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    )
