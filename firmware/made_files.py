"""Files that a script makes: written, or held against what the script would write."""

import argparse
import sys
from collections.abc import Callable, Mapping
from pathlib import Path


def write_or_check(
    arguments: list[str] | None, script: str, purpose: str, make: Callable[[], Mapping[Path, str]]
) -> int:
    """Write every file that is stale or, with `--check`, only name it.

    Parameters
    ----------
    arguments
        Command line without the program's name; None takes the process's own.
    script
        Name of the script in firmware/.
    purpose
        What it does, for its help.
    make
        Returns the files and their text.

    Returns
    -------
    int
        Exit status: 1 where `--check` found a stale file.
    """
    parser = argparse.ArgumentParser(description=purpose)
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 where stale")
    check = parser.parse_args(arguments).check
    texts = make()
    stale = [p for p, text in texts.items() if not p.is_file() or p.read_text("utf-8") != text]
    for path in stale:
        if check:
            sys.stderr.write(f"{path} is stale: run python firmware/{script}\n")
        else:
            path.write_text(texts[path], encoding="utf-8")
    return 1 if check and stale else 0
