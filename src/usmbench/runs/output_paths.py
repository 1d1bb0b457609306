"""Where a command is to write, looked at before it begins its work."""

import errno
import os
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path

from usmbench.errors import InputError
from usmbench.runs.columns import DATA_FILES, RUN_FILE
from usmbench.runs.output_files import cannot_write, real_path

_OF_A_RUN = (RUN_FILE, *DATA_FILES)


def check_outputs(
    outputs: Mapping[str, Path | str | None], inputs: Iterable[Path | str | None] = ()
) -> None:
    """Refuse output files that would cost data, or that cannot be written.

    Parameters
    ----------
    outputs
        The file that each argument names. None and the ``-`` of ``--json``, standard output, are
        left out, and so is a device or a pipe, which holds nothing.
    inputs
        What the command reads; names that are no file are left out.

    Raises
    ------
    usmbench.errors.InputError
        A file is an input, or part of a run, or named twice, or cannot be written, or is ``-``.
    """
    # A link that leads back to itself is for the reader to refuse.
    read = [Path(os.path.realpath(name)) for name in inputs if name is not None]
    taken: dict[Path, str] = {}
    for argument, name in outputs.items():
        if name is None or (argument == "--json" and name == "-"):
            continue
        file = Path(name)
        if str(name) == "-":
            raise InputError(f"{argument} - is no file, standard output takes --json; name a file")
        try:
            if _is_device(file):
                continue
            real = real_path(file)
            _check_harmless(file, real, read)
            _check_writable(real)
        except OSError as error:
            raise cannot_write(file, error) from error
        if real in taken:
            raise InputError(
                f"is named by {taken[real]} and by {argument}; name a file for each", file=file
            )
        taken[real] = argument


def _is_device(file: Path) -> bool:
    return file.exists() and not file.is_file() and not file.is_dir()


def _check_harmless(file: Path, real: Path, read: Iterable[Path]) -> None:
    """Refuse to replace what the command reads, and what was measured."""
    if any(_same(real, other) for other in read):
        raise InputError("is what this command reads; name another file", file=file)
    for name in _OF_A_RUN:
        own = real.with_name(name)
        if (real == own or _same(real, own)) and real.with_name(RUN_FILE).exists():
            raise InputError(f"is part of the run {file.parent}; name another file", file=file)


def _same(one: Path, other: Path) -> bool:
    """Whether both are one file, whatever letters a disk takes for alike."""
    return one.exists() and other.exists() and one.samefile(other)


def _check_writable(real: Path) -> None:
    """Try the folder, which alone knows what it allows; nothing is left in it."""
    if real.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    with tempfile.TemporaryFile(dir=real.parent):
        pass
