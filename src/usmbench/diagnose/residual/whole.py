"""What the views together show of a residual."""

from collections.abc import Sequence
from dataclasses import dataclass

from scipy.stats import chi2

from usmbench.diagnose.residual.basis import Basis
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.views import omnibus
from usmbench.model.applied import Applied

PLAIN_P_VALUE = 1e-3  # that the views together show something
_MATERIAL = 0.1  # of the noise's mean square


@dataclass(frozen=True, slots=True)
class Whole:
    """The test over all views of what a residual holds.

    Parameters
    ----------
    excess
        Square of the residual's part in the views, beyond what noise leaves there.
    p_value
        Probability of as much where nothing is wrong.
    n_rows
        Rows that it was taken over.
    """

    excess: float
    p_value: float
    n_rows: int

    @property
    def material(self) -> bool:
        """Whether there is more than a trifle."""
        return self.beyond(PLAIN_P_VALUE, _MATERIAL)

    def beyond(self, p_value: float, share: float) -> bool:
        """Return whether there is more than chance and a trifle leave.

        Parameters
        ----------
        p_value
            Probability of chance.
        share
            Share of the noise's mean square that is a trifle.
        """
        return self.p_value < p_value and self.excess > share * self.n_rows


def whole_test(problem: Problem, basis: Basis, effects: Sequence[Applied], spread: float) -> Whole:
    """Test a residual against all views together.

    Parameters
    ----------
    problem
        The problem.
    basis
        Directions to look in.
    effects
        The effects to take out first.
    spread
        Standard deviation of the whitened noise.
    """
    rank_ = basis.rank
    square = basis.square(problem.left(effects)) / spread**2
    excess, p_value = max(square - rank_, 0.0), float(chi2.sf(square, rank_))
    return Whole(excess, p_value, problem.n_rows)


def doubted_test(problem: Problem, effects: Sequence[Applied], spread: float) -> Whole:
    """Test what effects leave against all views together, where their form may be off.

    Parameters
    ----------
    problem
        The problem.
    effects
        The effects to take out first.
    spread
        Standard deviation of the whitened noise.
    """
    doubting = problem.doubting(effects)
    return whole_test(doubting, omnibus(doubting), effects, spread)


def excused(problem: Problem, spread: float) -> Whole:
    """Test how far what is no news would have to depart to explain a residual.

    Beyond chance it hides something: it takes what it never took in the model's own runs.

    Parameters
    ----------
    problem
        The problem.
    spread
        Standard deviation of the whitened noise.
    """
    departures, square = problem.excuses()
    p_value = float(chi2.sf(departures @ departures / spread**2, departures.size))
    return Whole(square / spread**2, p_value, problem.n_rows)
