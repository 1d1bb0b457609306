"""What is left over, in a sentence."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm, poisson

from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.whole import PLAIN_P_VALUE, Whole, excused
from usmbench.diagnose.result import Remainder, View
from usmbench.model.applied import Applied

Array = NDArray[np.float64]

_SAYS = {
    "phase": "the residual depends on the commanded phase, most around {at:.3g}°",
    "direction": "the residual depends on whether the phase rose or fell, most around {at:.3g}°",
    "time": "the residual changes over the run, most around {at:.3g} s",
    "gain over time": "the residual along the motion changes over the run, most around {at:.3g} s",
    "lag": "the residual follows the steps of the phase, most {at:.3g} windows after",
    "angle": "the residual depends on the shaft's angle, most around {at:.3g} rad",
    "speed": "the residual depends on the speed, most around {at:.3g} rad/s",
}
_VERSUS = {"gain over time": "time"}  # views of one thing
_LIKE_A_CAUSE = (
    "what is left resembles a cause of the library more than chance does, though it cannot be "
    "named for it"
)
# Times the noise of the model's runs from which on more is a finding: beside a name, and alone.
LOUD, LOUD_ALONE = 1.5, 1.3
_SELDOM = 1e-99  # so that one in so many can be written
_FAR = 3.0  # times the noise: one window in 370 by chance
_FEWEST_ROWS, _MOST_PARTS = 8, 12  # of a run, to say where in time most is left


@dataclass(frozen=True, slots=True)
class Beyond:
    """What is beyond the noise though no view by itself need show it.

    Parameters
    ----------
    n_rows
        Rows that were judged.
    n_far
        Of these, by how many single ones more than `_FAR` times the noise is left.
    times_noise
        Root mean square of all rows and of what is no news, over what noise leaves.
    p_rows, p_views
        Probabilities of as much in all rows and in all views together where nothing is wrong.
    p_excused
        Probability that the model is as far off as it would have to be to explain it all; 1 where
        something is named.
    where
        Where in time most is left.
    """

    n_rows: int
    n_far: int
    times_noise: float
    p_rows: float
    p_views: float
    p_excused: float
    where: str

    @classmethod
    def of(
        cls, problem: Problem, effects: Sequence[Applied], spread: float, views: Whole
    ) -> "Beyond":
        """Return what effects leave.

        Parameters
        ----------
        problem
            The problem.
        effects
            All that is named.
        spread
            Standard deviation of the whitened noise.
        views
            The test over all views of what they leave.
        """
        left, n_rows = problem.left(effects) / spread, problem.n_rows
        square, rows = float(left @ left), left[:n_rows]
        return cls(
            n_rows,
            int(np.count_nonzero(np.abs(rows) > _FAR)),
            float(np.sqrt(square / n_rows)),
            float(chi2.sf(square, n_rows)),
            views.p_value,
            1.0 if effects else excused(problem, spread).p_value,
            _where(problem, rows),
        )

    def says(self) -> str:
        """Return the sentence of what of it is beyond chance, the plainest first."""
        by_chance = 2.0 * float(norm.sf(_FAR)) * self.n_rows
        if poisson.sf(self.n_far - 1, by_chance) < PLAIN_P_VALUE:
            return (
                "single windows are off by more than noise leaves, though no view by itself shows "
                f"it: {self.n_far} of {self.n_rows} by more than {_FAR:g} times the noise, where "
                f"chance leaves {by_chance:.2g}, most {self.where}"
            )
        if self.p_rows < PLAIN_P_VALUE:
            return (
                "all windows together show more than noise leaves, though no view does by itself: "
                f"{self.times_noise:.3g} times as much (root mean square), most {self.where}"
            )
        if self.p_views < PLAIN_P_VALUE:
            return (
                "all views together show more than noise leaves, though none of them does by "
                f"itself: chance shows as much in one run of {1.0 / max(self.p_views, _SELDOM):.0e}"
            )
        if self.p_excused < PLAIN_P_VALUE:
            return (
                "what is left looks like an error of the model itself, but larger than the runs "
                "it was identified on let one expect"
            )
        return _LIKE_A_CAUSE


def _where(problem: Problem, rows: Array) -> str:
    """Say around which time of which run most is left."""
    parts: list[tuple[float, str]] = []
    several, start = len(problem.stretches) > 1, 0
    for stretch, valid in zip(problem.stretches, problem.valid, strict=True):
        t_s = stretch.context.t_s[valid]
        squares, start = rows[start : start + t_s.size] ** 2, start + t_s.size
        n_parts = int(np.clip(t_s.size // _FEWEST_ROWS, 1, _MOST_PARTS))
        of_run = f" of {stretch.name}" if several else ""
        parts += [
            (float(np.mean(squares[k])), f"around {np.mean(t_s[k]):.3g} s{of_run}")
            for k in np.array_split(np.arange(t_s.size), n_parts)
            if k.size
        ]
    return max(parts)[1]


def _scatter_says(wave_hz: float | None) -> str:
    """Say what a scatter that no view shows is like, and what to look for."""
    if wave_hz is None:
        return (
            "without a pattern: look for what is faster than a window, such as a ripple of the "
            "supply"
        )
    return (
        f"most of it in a wave of {wave_hz:.3g} Hz, or of one that the windows fold to it: look "
        "for what swings so, such as a ripple of the supply"
    )


def describe(
    views: Sequence[View],
    spread: float,
    beyond: Beyond | None = None,
    wave_hz: float | None = None,
) -> Remainder:
    """Return what shows most plainly that something is left after the extension.

    Parameters
    ----------
    views
        The views.
    spread
        Standard deviation of the noise that no view shows, over that of the model's runs.
    beyond
        What is left where no view by itself shows it; None where it looks like a cause that is
        not named.
    wave_hz
        Frequency of the wave that most of what is left is; None for none.
    """
    worst = max(views, key=lambda view: view.excess_after)
    most = LOUD if spread > LOUD else 1.0
    if spread > LOUD_ALONE and worst.excess_after < most:
        return Remainder(
            "noise",
            f"the windows scatter {spread:.2g} times as widely as in the model's runs, "
            + _scatter_says(wave_hz),
        )
    if worst.excess_after < 1.0:
        return Remainder("time", _LIKE_A_CAUSE if beyond is None else beyond.says())
    k = int(np.argmax(np.abs(worst.after_rad_s) / worst.band_rad_s))
    says = _SAYS[worst.versus].format(at=float(worst.centre[k]))
    size = float(worst.after_rad_s[k])
    return Remainder(
        _VERSUS.get(worst.versus, worst.versus),
        f"{says} ({size:+.3g} rad/s, {worst.excess_after:.2g} times what noise would leave)",
    )
