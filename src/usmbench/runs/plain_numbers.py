"""Rows of plain numbers, a million of them in a second."""

import io
from typing import cast

import numpy as np
from numpy.typing import NDArray

# Rows that are read together still lie in the processor's cache.
_PART_BYTES = 1 << 20
_COMMA, _LINE_END, _MINUS, _PLUS, _E = b",\n-+e"


def plain_numbers(content: bytes, start: int, n_columns: int) -> NDArray[np.float64] | None:
    """Return the numbers of a CSV file, None where its rows hold anything but plain numbers.

    Plain are digits with at most one point and an exponent such as e-05. Of what the standard
    library and numpy have, only SciPy's reader of Matrix Market files finds the nearest double of
    twelve digits without arithmetic on long integers, but it passes over what follows a number;
    so the text is checked first.

    Parameters
    ----------
    content
        The file.
    start
        Where its first row begins.
    n_columns
        Numbers in a row.

    Returns
    -------
    numpy.ndarray or None
        Shape (n_columns, N), each column contiguous.
    """
    from scipy.io import mmread  # takes 0.2 s to import

    parts = [np.empty((n_columns, 0))]
    while start < len(content):
        end = content.find(b"\n", start + _PART_BYTES) + 1 or len(content)
        rows = content[start:end].replace(b"\r\n", b"\n").removesuffix(b"\n") + b"\n"
        n_rows = rows.count(b"\n")
        if not _are_plain(rows, n_rows, n_columns):
            return None
        head = b"%%%%MatrixMarket matrix array real general\n%d %d\n" % (n_columns, n_rows)
        try:
            numbers = mmread(io.BytesIO(head + rows.replace(b",", b"\n")))
        except ValueError:
            return None
        parts.append(cast("NDArray[np.float64]", numbers))
        start = end
    return np.concatenate(parts, axis=1)


def _are_plain(rows: bytes, n_rows: int, n_columns: int) -> bool:
    """Return whether every field is empty, a sign or point alone, or one number and no more."""
    marks = rows.translate(None, b"0123456789+-")
    whole_rows = (b"," * (n_columns - 1) + b"\n") * n_rows
    if marks.translate(None, b".e") != whole_rows:
        return False
    if any(twice in marks for twice in (b"..", b"e.", b"ee")):
        return False
    letters = np.frombuffer(rows, np.uint8)
    signs = np.flatnonzero((letters == _MINUS) | (letters == _PLUS))
    before_sign = letters[signs - 1]  # of a sign that is the first letter, the last line end
    leads = (before_sign == _COMMA) | (before_sign == _LINE_END) | (before_sign == _E)
    after_e = letters[np.flatnonzero(letters == _E) + 1]
    after_e_sign = letters[signs[before_sign == _E] + 1]
    follows = np.concatenate([after_e, after_e_sign])
    return bool(leads.all() and not np.isin(follows, (_COMMA, _LINE_END)).any())
