"""What is printed for somebody who has gone goes nowhere, and nothing stays open for it."""

import os
from pathlib import Path

from usmbench.output import drop_output


def _next_descriptor() -> int:
    number = os.dup(2)
    os.close(number)
    return number


def test_a_stream_that_is_dropped_takes_no_descriptor(tmp_path: Path) -> None:
    path = tmp_path / "printed"
    with path.open("w", encoding="utf-8") as stream:
        free = _next_descriptor()
        drop_output(stream)
        assert _next_descriptor() == free
        print("lost", file=stream, flush=True)
    assert not path.read_text(encoding="utf-8")
