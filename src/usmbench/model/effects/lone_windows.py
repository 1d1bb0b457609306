"""Causes that strike single windows by chance, and the windows that tell them apart."""

from abc import abstractmethod
from dataclasses import dataclass, fields, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binom, chi2

from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context

Interval = tuple[float, float, float]
AS_LIKELY = 1.92
"""Of a log-likelihood: 95 % of χ² with one degree of freedom, halved (Wilks 1938)."""
STRAY = 0.02
"""Of the windows that stand alone: off the other way, or where a cause has no part."""
_ANOTHER = 1.5  # times a size: a scratch grows by whole lines. Nothing measured sets it


@dataclass(frozen=True, slots=True)
class LoneWindows:
    """Windows in which the motor runs steadily, and which of them stand alone; shapes (N,).

    Parameters
    ----------
    speed_rad_s
        Simulated speed.
    deviation_rad_s
        By how much more than in the windows beside it the measured speed is off the simulated one.
    alone
        Whether the window is far from its neighbours.
    from_rad, to_rad
        Lower and higher end of the angles through which the shaft turns, by the counter.
    run
        Index of the window's run.
    window_s
        Duration of a window.
    lacks_rad
        By how much a revolution is less by the counter, for what strikes windows that are left out.
    """

    speed_rad_s: Array
    deviation_rad_s: Array
    alone: NDArray[np.bool_]
    from_rad: Array
    to_rad: Array
    run: NDArray[np.int64]
    window_s: float
    lacks_rad: float = 0.0

    @classmethod
    def of_one_run(
        cls, speed_rad_s: Array, deviation_rad_s: Array, alone: NDArray[np.bool_], window_s: float
    ) -> "LoneWindows":
        """Return windows that follow each other, whose angles are their speeds added up.

        Parameters
        ----------
        speed_rad_s, deviation_rad_s, alone, window_s
            As in `LoneWindows`.
        """
        ends_rad = np.cumsum(np.concatenate([[0.0], speed_rad_s])) * window_s
        from_rad, to_rad = np.sort(np.stack([ends_rad[:-1], ends_rad[1:]]), axis=0)
        run = np.zeros(speed_rad_s.size, dtype=np.int64)
        return cls(speed_rad_s, deviation_rad_s, alone, from_rad, to_rad, run, window_s)

    def of(self, rows: NDArray[np.bool_]) -> "LoneWindows":
        """Return some of the windows.

        Parameters
        ----------
        rows
            Which, shape (N,).
        """
        columns = {f.name: getattr(self, f.name)[rows] for f in fields(self)[:-2]}
        return replace(self, **columns)

    def rate_hz(self, among: NDArray[np.bool_]) -> Interval:
        """Return how often a window stands alone: low end, value, high end of 95 %.

        The interval is Garwood's exact one for a Poisson count (1936, doi:10.2307/2333958).

        Parameters
        ----------
        among
            The windows to count in, shape (N,).
        """
        count = int(np.count_nonzero(self.alone & among))
        time_s = max(int(np.count_nonzero(among)), 1) * self.window_s
        low = float(chi2.ppf(0.025, 2 * count)) if count else 0.0
        high = float(chi2.ppf(0.975, 2 * count + 2))
        return 0.5 * low / time_s, count / time_s, 0.5 * high / time_s

    def size_rad_s(self, among: NDArray[np.bool_]) -> Interval:
        """Return how far the windows that stand alone are off: low end, median, high end of 95 %.

        The interval is that of the sign test, whatever the distribution; of fewer than six sizes
        it is all of them.

        Parameters
        ----------
        among
            The windows to look at, shape (N,).
        """
        sizes = np.sort(np.abs(self.deviation_rad_s[self.alone & among]))
        if sizes.size == 0:
            return 0.0, 0.0, 0.0
        outside = max(int(binom.ppf(0.025, sizes.size, 0.5)) - 1, 0)
        return float(sizes[outside]), float(np.median(sizes)), float(sizes[-1 - outside])


@dataclass(frozen=True, slots=True)
class Weighed:
    """How well a sporadic cause fits windows that stand alone.

    Parameters
    ----------
    log_likelihood
        Of where they are, and which way they are off, less the price of what was chosen to fit.
    values
        Low end, value and high end of 95 % of each parameter, by name.
    """

    log_likelihood: float
    values: dict[str, Interval]


class SporadicEffect(Effect):
    """A cause that strikes single windows; no simulation foresees which.

    One of its parameters is `rate_hz`, how often. Where a model has the cause already, it is news
    only if it strikes more often, or one of its `sizes` is another.
    """

    stage = "counter"
    sporadic: ClassVar[bool] = True
    sizes: ClassVar[tuple[str, ...]] = ()  # parameters that are the same in every run

    @staticmethod
    def struck(draw: np.random.Generator, context: Context, rate_hz: float) -> NDArray[np.bool_]:
        """Return which windows are struck, shape (N,): the same for the same run.

        Parameters
        ----------
        draw
            Where chance comes from, seeded by the cause.
        context
            The stretch.
        rate_hz
            How often a window is struck.
        """
        struck: NDArray[np.bool_] = draw.random(context.n) < rate_hz * context.window_s
        return struck

    @abstractmethod
    def weigh(self, windows: LoneWindows) -> Weighed:
        """Return how well the cause fits.

        Parameters
        ----------
        windows
            The windows, of which some stand alone.
        """

    def is_known(self, found: Weighed, values: Values) -> bool:
        """Return whether what was found is as large as what is known.

        Parameters
        ----------
        found
            What was found.
        values
            The parameters that are known.
        """
        for name in self.sizes:
            low, _, high = found.values[name]
            if low > _ANOTHER * values[name] or high < values[name] / _ANOTHER:
                return False
        return True

    def lacks_rad(self, values: Values) -> float:
        """Return by how much a revolution is less by a counter where the cause is.

        Parameters
        ----------
        values
            Its parameters.
        """
        return 0.0

    def shown_against(self, windows: LoneWindows) -> tuple[str, Array]:
        """Return what a figure shows the windows against: its label with the unit, values (N,).

        Parameters
        ----------
        windows
            The windows that it was weighed by.
        """
        return "simulated speed (rad/s)", windows.speed_rad_s

    def touched(self, windows: LoneWindows, every: LoneWindows) -> NDArray[np.bool_]:
        """Return which windows it may move though they do not stand alone, shape of `every`.

        Of one that is `left_out`, these are; of the others, whose windows chance chooses, none.

        Parameters
        ----------
        windows
            The windows that it was weighed by.
        every
            All windows.
        """
        return np.zeros(every.alone.size, dtype=np.bool_)
