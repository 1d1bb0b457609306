"""Who watches a sweep while it runs, and what is told."""

from dataclasses import dataclass
from typing import Protocol

from usmbench.sweep.interlocks import InterlockState
from usmbench.sweep.rows import PairRow, WindowRow


@dataclass(frozen=True, slots=True)
class Standing:
    """Where a sweep stands after a window.

    Parameters
    ----------
    windows_left
        Windows that the plan still has.
    interlocks
        What the interlocks have seen.
    waiting_for_load
        Whether the operator is setting the load, the drive being off.
    """

    windows_left: int
    interlocks: InterlockState
    waiting_for_load: bool = False


class Observer(Protocol):
    """Is told of every window and every pair; the panel on the terminal is one."""

    def window(self, row: WindowRow, standing: Standing) -> None:
        """Take one window; must return at once."""

    def settled(self, pair: PairRow) -> None:
        """Take the pair of a dwell that has just ended; must return at once."""
