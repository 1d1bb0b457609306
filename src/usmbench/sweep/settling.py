"""When a dwell counts as settled, and the pair it gives."""

from collections import deque
from math import sqrt

from usmbench.settings.plan import Settle


class Settling:
    """Watches the speeds of one dwell.

    Only windows after the criterion was met count: which windows those are is then known the
    moment each is measured, and a window is never called settled after the event.

    Parameters
    ----------
    settle
        The criterion, or None where nothing counts (warm-up).
    """

    def __init__(self, settle: Settle | None):
        self._settle = settle
        self._recent: deque[float] = deque(maxlen=settle.over_windows if settle else 0)
        self.n_windows = 0
        self.n_settled = 0
        self.is_settled = settle is not None and not settle.over_windows and not settle.min_windows
        self._mean_rad_s = 0.0
        self._squares = 0.0

    def add(self, speed_rad_s: float) -> int:
        """Take one window; return 1 where it counts for the pair, else 0.

        Parameters
        ----------
        speed_rad_s
            Speed of the window.
        """
        self.n_windows += 1
        if self.is_settled:
            self._count(speed_rad_s)
            return 1
        settle = self._settle
        if settle is not None:
            if self.n_windows > settle.min_windows:
                self._recent.append(speed_rad_s)
            # This window is the last of those that prove it; the next is the first to count.
            self.is_settled = self.n_windows >= settle.min_windows and self._stands_still(settle)
        return 0

    def _count(self, speed_rad_s: float) -> None:
        """Update mean and sum of squares (Welford, doi:10.1080/00401706.1962.10490022)."""
        self.n_settled += 1
        step = speed_rad_s - self._mean_rad_s
        self._mean_rad_s += step / self.n_settled
        self._squares += step * (speed_rad_s - self._mean_rad_s)

    def _stands_still(self, settle: Settle) -> bool:
        n = settle.over_windows
        if n == 0:
            return True
        if len(self._recent) < n:
            return False
        half = n // 2
        speeds = list(self._recent)
        earlier, later = sum(speeds[:half]) / half, sum(speeds[-half:]) / half
        tolerance = max(settle.tolerance_rad_s, settle.relative * abs(later))
        return abs(later - earlier) <= tolerance

    def has_enough(self, windows: int, extend_to_windows: int) -> bool:
        """Return whether the dwell has what it needs, or has run out of windows.

        Parameters
        ----------
        windows
            Windows of a dwell that settles in time.
        extend_to_windows
            Windows after which one that has not settled ends all the same.
        """
        if self.n_windows < windows:
            return False
        if self._settle is None or self.n_windows >= extend_to_windows:
            return True
        return self.n_settled >= max(1, self._settle.over_windows)

    def pair(self) -> tuple[float, float, int]:
        """Return mean speed, its standard deviation and the number of windows they come from.

        Of a dwell that never settled, the last windows that were to prove it.
        """
        if self.n_settled:
            return self._mean_rad_s, _deviation(self._squares, self.n_settled), self.n_settled
        n = len(self._recent)
        mean_rad_s = sum(self._recent) / n
        squares = sum((speed_rad_s - mean_rad_s) ** 2 for speed_rad_s in self._recent)
        return mean_rad_s, _deviation(squares, n), n


def _deviation(squares: float, n: int) -> float:
    return sqrt(squares / (n - 1)) if n > 1 else 0.0
