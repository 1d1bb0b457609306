"""Where ``--json`` goes: a file, or standard output and nothing else there."""

import json
import sys
from pathlib import Path
from typing import Any

from usmbench.errors import InputError


def write_json(target: str, content: dict[str, Any]) -> None:
    """Write a mapping as JSON.

    Parameters
    ----------
    target
        A file, or ``-`` for standard output.
    content
        The mapping; NaN and infinity are refused, as JSON has neither.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    text = json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False) + "\n"
    if target == "-":
        sys.stdout.write(text)
        return
    try:
        Path(target).write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(
            f"cannot be written ({error.strerror}); give --json a file in a folder that exists",
            file=target,
        ) from error
