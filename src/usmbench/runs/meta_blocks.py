"""run.yaml read key by key: of ten thousand runs, a list needs few keys and most say the same.

A key and what is indented below it is parsed by itself, when it is asked for, and a block that an
earlier run had word for word is not parsed again. What cannot be cut like this (flow style, an
alias from one block to another) is parsed whole.
"""

import re
from collections.abc import Callable
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, Final, TypeVar

import yaml

from usmbench.runs.columns import FORMAT, RUN_FILE
from usmbench.runs.meta import MOST_BYTES, run_source
from usmbench.settings.regular_file import refuse_endless

_Answer = TypeVar("_Answer")

_BLOCKS_KEPT: Final = 4096
_NAME = r"[A-Za-z_][A-Za-z0-9_]*:(?=[ \n])"
# Each begins with the line end before it: a literal first makes the search fast.
_KEY = re.compile(rf"\n({_NAME})")
# At the first column: anything but a plain key, a list's item or a comment.
_ODD_LINE = re.compile(rf"\n(?:---|(?!{_NAME})[^\s#-])")
# Only comments and the document's start may come before the first key.
_PREFACE = re.compile(r"\n(?:\ufeff|#[^\n]*\n|---[ \t]*\n|[ \t]*\n)*")
# An anchor may be used in another block; a tag may mean anything.
_ANCHOR_OR_TAG = re.compile(r"(?<![^\s\[{,:])[&*!]\S")
_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class MetaBlocks:
    """What one run.yaml says, parsed as far as it is asked.

    Parameters
    ----------
    folder
        The run folder.

    Raises
    ------
    usmbench.errors.InputError
        No such file, one without an end, or not of a format this version reads.
    """

    def __init__(self, folder: Path):
        self._folder = folder
        self._whole: dict[str, Any] | None = None
        self._blocks = _cut(_text(folder / RUN_FILE))
        if self._blocks is None or self.get("format") != FORMAT:
            self._whole = run_source(folder).document

    def get(self, key: str) -> Any:
        """Return the value of a top-level key, None where there is none.

        Parameters
        ----------
        key
            The key.

        Raises
        ------
        usmbench.errors.InputError
            The file is not YAML.
        """
        return self._ask(key, _parsed, lambda value: value)

    def values(self, dotted_key: str) -> list[Any]:
        """Return the values that a dotted key leads to; a list on the way stands for its items.

        Parameters
        ----------
        dotted_key
            Such as ``bench.generator.port``.

        Raises
        ------
        usmbench.errors.InputError
            The file is not YAML.
        """
        first, *rest = dotted_key.split(".")
        return self._ask(first, partial(_below, keys=rest), partial(_followed, keys=rest))

    def _ask(
        self, key: str, of_block: Callable[[str], _Answer], of_value: Callable[[Any], _Answer]
    ) -> _Answer:
        """Answer from a key's block, or where blocks will not do from the file parsed whole."""
        if self._whole is None and self._blocks is not None:
            try:
                return of_block(self._blocks.get(key, ""))
            except (yaml.YAMLError, ValueError):
                self._whole = run_source(self._folder).document
        return of_value(None if self._whole is None else self._whole.get(key))


def _text(path: Path) -> str:
    """Return what the file says, nothing where that is left to `run_source` to refuse."""
    refuse_endless(path)
    try:
        with path.open(encoding="utf-8") as file:
            text = file.read(MOST_BYTES + 1)
    except (OSError, UnicodeDecodeError):
        return ""
    return text if len(text) <= MOST_BYTES else ""


def _below(block: str, keys: list[str]) -> list[Any]:
    """Return what keys lead to in a block, cut as long as it can be."""
    while keys:
        blocks = _cut(_dedented(block)) if block.startswith("\n") else None
        if blocks is None:
            break
        block, keys = blocks.get(keys[0], ""), keys[1:]
    return _followed(_parsed(block), keys)


def _dedented(block: str) -> str:
    """Return a block without the indentation of its first line."""
    lines = block.lstrip("\n")
    indent = len(lines) - len(lines.lstrip(" "))
    return block.replace("\n" + " " * indent, "\n").lstrip("\n")


def _followed(value: Any, keys: list[str]) -> list[Any]:
    """Return what keys lead to in a value."""
    found = [value]
    for key in keys:
        found = [item.get(key) for item in _items(found) if isinstance(item, dict)]
    return [item for item in _items(found) if item is not None]


def _items(values: list[Any]) -> list[Any]:
    """Return the values with the items of a list in place of the list."""
    flat = []
    for value in values:
        flat += _items(value) if isinstance(value, list) else [value]
    return flat


def _cut(text: str) -> dict[str, str] | None:
    """Return the text of each top-level key's value, None where the file is not made of blocks."""
    text = "\n" + text
    starts = list(_KEY.finditer(text))
    preface = _PREFACE.match(text)
    if not starts or preface is None or preface.end() != starts[0].start(1):
        return None
    if _ODD_LINE.search(text, starts[0].start()):
        return None
    if any(mark in text for mark in "&*!") and _ANCHOR_OR_TAG.search(text):
        return None
    ends = [start.start() for start in starts[1:]] + [len(text)]
    return {start[1][:-1]: text[start.end() : end] for start, end in zip(starts, ends, strict=True)}


@lru_cache(maxsize=_BLOCKS_KEPT)
def _parsed(block: str) -> Any:
    """Parse a value; callers do not change what they get."""
    # Under a key of its own, indentation and the list at the key's own column mean the same.
    return yaml.load("x:" + block, _Loader)["x"] if block else None  # noqa: S506 - a safe loader
