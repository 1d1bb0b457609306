"""Work that never ends, for a process of its own to import."""

import time
from typing import Any


def stuck(*_: Any) -> None:
    """Do nothing for longer than any test."""
    time.sleep(3600.0)
