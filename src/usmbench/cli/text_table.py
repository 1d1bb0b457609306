"""Lines for a terminal: columns under their heads, and nothing in them that moves the cursor."""

from collections.abc import Sequence

from usmbench.report.plain_text import printable


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
