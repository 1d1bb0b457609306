"""Text from files that others wrote, safe to show."""

_LONGEST = 60


def printable(text: str) -> str:
    """Return text with `�` for what a terminal would obey instead of show.

    Parameters
    ----------
    text
        Such as a name from a file that somebody else wrote.
    """
    return "".join(letter if letter.isprintable() else "�" for letter in text)


def file_name(text: str) -> str:
    """Return text as a part of a file's name, with `_` for all but letters, digits, and `-.`.

    Parameters
    ----------
    text
        Such as the name of a plan.
    """
    kept = "".join(c if c.isalnum() or c in "-." else "_" for c in text).strip(".")
    return kept[:_LONGEST] or "unnamed"


def short_name(name: str) -> str:
    """Return a run's name that fits over a plot: of a long path, its end.

    Parameters
    ----------
    name
        Folder or file.
    """
    shown = printable(name)
    return shown if len(shown) <= _LONGEST else "…" + shown[1 - _LONGEST :]
