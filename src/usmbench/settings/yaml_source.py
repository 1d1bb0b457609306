"""YAML read as `safe_load` reads it, but dates as text; every node's line is kept for messages."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from usmbench.errors import InputError
from usmbench.settings.regular_file import refuse_endless

PathInDocument = tuple[str | int, ...]

MAX_BYTES = 1_000_000
MAX_DEPTH = 30
MAX_NODES = 1_000_000  # that aliases may stand for, however long the file
# Beyond this no setting of a bench makes sense, and arithmetic on Python's unbounded integers
# would fail far from the line that is wrong.
MAX_NUMBER = 1e12
_TOO_DEEP = f"is nested too deeply; keep to {MAX_DEPTH} levels"
_ALIASES = "its aliases (*name) multiply or lead in a circle; write out what they are for"


@dataclass(frozen=True, slots=True)
class Source:
    """A document and where each part of it was written.

    Parameters
    ----------
    file
        The file's name, for messages.
    document
        What the file says.
    lines
        Line of each value, counted from 1; empty for a document that was never a file.
    """

    file: str
    document: Any
    lines: dict[PathInDocument, int] = field(default_factory=dict)

    def error(self, path: PathInDocument, message: str) -> InputError:
        """Return the error that points at one part of the document.

        Parameters
        ----------
        path
            Keys and indices that lead to the part.
        message
            What is wrong there and how to mend it.
        """
        at = path
        while at and at not in self.lines:
            at = at[:-1]
        where = spelled(path)
        text = f"{where}: {message}" if where else message
        return InputError(text, file=self.file, line=self.lines.get(at))


def spelled(path: PathInDocument) -> str:
    """Return a path the way a user writes it, such as ``passes[0].phase_deg``.

    Parameters
    ----------
    path
        Keys and indices.
    """
    words = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)
    return "".join(words).removeprefix(".")


class _Loader(yaml.SafeLoader):
    """Dates stay the text that they are in JSON, and no date is beyond the calendar."""

    yaml_implicit_resolvers = {  # noqa: RUF012 - PyYAML's own way
        first: [(tag, pattern) for tag, pattern in resolvers if not tag.endswith(":timestamp")]
        for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
    }


# What PyYAML's constructors let through besides its own errors, on text that only looks like YAML.
_YAML_TROUBLE = (ValueError, LookupError, AttributeError, OverflowError, TypeError)


def read_source(
    file: Path,
    most_bytes: int = MAX_BYTES,
    *,
    plain: bool = True,
    mend: str = "check the path",
) -> Source:
    """Read a YAML file.

    Parameters
    ----------
    file
        The file.
    most_bytes
        What is longer is refused unread.
    plain
        As in `parse_source`.
    mend
        What to do where it cannot be opened.

    Raises
    ------
    usmbench.errors.InputError
        It cannot be read, is too long, or is not plain YAML.
    """
    refuse_endless(file)
    try:
        with file.open("rb") as stream:
            content = stream.read(most_bytes + 1)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"cannot be read: {reason}; {mend}", file=file) from None
    if len(content) > most_bytes:
        raise InputError(f"is longer than {most_bytes} bytes: check the path", file=file)
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise InputError("is not UTF-8 text; save it as UTF-8", file=file, line=line) from None
    return parse_source(text, str(file), plain=plain)


def parse_source(text: str, file: str, *, plain: bool = True) -> Source:
    """Parse YAML text; aliases that multiply are refused.

    Parameters
    ----------
    text
        The file's content.
    file
        Its name, for messages.
    plain
        Whether duplicate keys, keys that are no words, merge keys and numbers without meaning are
        refused too, as settings need none of them.

    Raises
    ------
    usmbench.errors.InputError
        The text is not YAML, or not the plain YAML a settings file needs.
    """
    loader: yaml.SafeLoader | None = None
    try:
        loader = _Loader(text)
        node = loader.get_single_node()
        if node is None:
            raise InputError("is empty; write into it what it is to say", file=file)
        lines = {path: at.start_mark.line + 1 for path, at in _walk(node, file, len(text), plain)}
        document = loader.construct_document(node)
    except yaml.YAMLError as error:
        raise _yaml_error(error, file) from None
    except RecursionError:
        raise InputError(_TOO_DEEP, file=file) from None
    except _YAML_TROUBLE as error:
        message = f"holds a value YAML cannot make sense of: {_one_line(str(error))}"
        raise InputError(message, file=file) from None
    finally:
        if loader is not None:
            loader.dispose()
    source = Source(file, document, lines)
    if plain:
        _check_numbers(source, document, ())
    return source


def _walk(
    root: yaml.Node, file: str, length: int, plain: bool
) -> Iterator[tuple[PathInDocument, yaml.Node]]:
    """Yield every node and its path.

    An alias may lead back to its own parent; without, no node is shorter than a letter.
    """
    waiting: list[tuple[PathInDocument, yaml.Node]] = [((), root)]
    seen = 0
    while waiting:
        path, node = waiting.pop()
        seen += 1
        line = node.start_mark.line + 1
        if len(path) > MAX_DEPTH:
            raise InputError(_TOO_DEEP, file=file, line=line)
        if seen > min(length, MAX_NODES):
            raise InputError(_ALIASES, file=file, line=line)
        yield path, node
        if isinstance(node, yaml.SequenceNode):
            waiting += [((*path, index), child) for index, child in enumerate(node.value)]
        elif isinstance(node, yaml.MappingNode):
            own = _children(path, node, file)
            waiting += own if plain else (((*path, str(key.value)), at) for key, at in node.value)


def _children(
    path: PathInDocument, node: yaml.MappingNode, file: str
) -> Iterator[tuple[PathInDocument, yaml.Node]]:
    seen: dict[str, int] = {}
    for key, child in node.value:
        line = key.start_mark.line + 1
        name = key.value if isinstance(key, yaml.ScalarNode) else None
        if name is None or key.tag != "tag:yaml.org,2002:str":
            shown = "a list or mapping" if name is None else repr(name)
            message = f"a key must be a plain word, not {shown}; see the examples"
            raise InputError(message, file=file, line=line)
        if name in seen:
            message = f"{spelled((*path, name))}: already given on line {seen[name]}; remove one"
            raise InputError(message, file=file, line=line)
        seen[name] = line
        yield (*path, name), child


def _check_numbers(source: Source, value: Any, path: PathInDocument) -> None:
    if isinstance(value, dict):
        for key, item in value.items():
            _check_numbers(source, item, (*path, key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            _check_numbers(source, item, (*path, index))
    elif isinstance(value, int | float) and not abs(value) <= MAX_NUMBER:
        # No float holds a whole number of 400 digits, to ask whether it is one.
        unordered = isinstance(value, float) and math.isnan(value)
        shown = "not a number" if unordered else "too large a number"
        raise source.error(path, f"{shown}; choose one up to {MAX_NUMBER:g}")


def _yaml_error(error: yaml.YAMLError, file: str) -> InputError:
    mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
    problem = getattr(error, "problem", None) or getattr(error, "reason", None) or "unreadable"
    line = None if mark is None else mark.line + 1
    return InputError(f"is not YAML: {_one_line(str(problem))}", file=file, line=line)


def _one_line(text: str) -> str:
    return " ".join(text.split())[:200]
