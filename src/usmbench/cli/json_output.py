"""Where ``--json`` goes: a file, or standard output and nothing else there."""

import json
import sys
from pathlib import Path
from typing import Any

from usmbench.runs.output_files import escaped, write_output


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
    text = escaped(json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False)) + "\n"
    if target == "-":
        sys.stdout.write(text)
        return
    write_output(Path(target), text)
