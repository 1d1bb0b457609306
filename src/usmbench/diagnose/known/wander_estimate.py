"""The wander estimated from the departures that several runs show."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, helmert
from scipy.stats import chi2
from scipy.stats import t as student

from usmbench.diagnose.known.wander import Wander, lowest_shown, wander_of_deviations

Array = NDArray[np.float64]

_ANYWHERE = 10.0  # of the widest deviations: nothing says where the mean of the runs lies
_FEWEST = 0.5  # degrees of freedom that an estimate needs
_MOST_ROUNDS, _AT_REST = 300, 1e-3
_SWEEPS, _PLAUSIBLY = 3, 0.7
# A day's gain passes for a cause beyond so many deviations (5 % over some 20 causes), and ought to
# on one day in forty: by Student's distribution, few runs ask for a wider one. What else wanders
# lies less along any cause, and wider would cost the names of others (docs/decisions/0006).
_GAIN, _NAMED, _DAYS = 0, 3.0, 0.025  # the gain is the first of the kinds
_TRIED, _BEYOND = 200, 4.0  # plausible deviations: how many, and the last, of the widest


def measured_wander(widest: Wander, least: Wander, gram: Array, slope: Array) -> Wander:
    """Estimate the wander from what the runs show of their departures.

    First the most likely standard deviations: each is that of the departures, as they are estimated
    under it, over as many of them as the runs determine (MacKay 1992,
    doi:10.1162/neco.1992.4.3.415). Of departures that look alike, as a gain and less friction do,
    those go that the others make unlikely. A standard deviation of few values is itself uncertain:
    the one is taken below which it lies at odds of 7 to 3, the others being as they are, and any
    order of magnitude as plausible beforehand; of the gain at longer odds where few runs tell of
    it.

    Parameters
    ----------
    widest, least
        What any run may be off by, and what stands in where the runs do not show it.
    gram, slope
        Normal equations of each run's departures, all that is learnt beside them taken out, shape
        (R, W, R, W) and (R, W).
    """
    if slope.shape[0] < 2:
        return least
    unit, kinds = widest.deviations, widest.kinds
    gram, slope = _from_mean(gram * unit[:, None, None] * unit, slope * unit)
    floor = lowest_shown(least).deviations / unit
    told = _determined(gram, slope, np.ones(unit.size), kinds)[1]
    shown, odds = (told > _FEWEST) & (floor < 1.0), _below(told, kinds)
    size = np.where(shown, 1.0, least.deviations / unit)
    size = _likeliest(gram, slope, size, shown, floor, kinds)
    for kind in np.tile(np.unique(kinds[shown]), _SWEEPS):
        which = kinds == kind
        size[which] = _plausible(gram, slope, size, which, float(floor[which][0]), odds[which][0])
    return wander_of_deviations(size * unit, least)


def beside(gram: Array, slope: Array, own: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Return the normal equations of some coefficients with the others learnt beside them.

    Parameters
    ----------
    gram, slope
        Normal equations of all, with what is known of the others beforehand, shape (K, K) and (K,).
    own
        Which to keep, shape (K,).
    """
    learnt = np.linalg.solve(gram[~own][:, ~own], np.c_[gram[~own][:, own], slope[~own]])
    left = np.c_[gram[own][:, own], slope[own]] - gram[own][:, ~own] @ learnt
    return left[:, :-1], left[:, -1]


def _from_mean(gram: Array, slope: Array) -> tuple[Array, Array]:
    """Return the normal equations of R − 1 contrasts between runs, their mean learnt beside them.

    The mean belongs to the model. That the runs add up to nothing would not do: where one of them
    shows nothing of a departure, it would have to make up for what the others have in common.
    """
    apart, common = helmert(slope.shape[0]), gram.sum(axis=2)
    mean = common.sum(axis=0) + np.eye(slope.shape[1]) / _ANYWHERE**2
    along = np.tensordot(apart, common, 1)
    toward = np.tensordot(along, np.linalg.inv(mean), 1)
    contrasts = np.einsum("kr,rvsw,ls->kvlw", apart, gram, apart)
    left = contrasts - np.tensordot(toward, along.transpose(2, 0, 1), 1)
    return left, apart @ slope - toward @ slope.sum(axis=0)


def _likeliest(
    gram: Array,
    slope: Array,
    size: Array,
    shown: NDArray[np.bool_],
    floor: Array,
    kinds: NDArray[np.int64],
) -> Array:
    """Return the likeliest deviations, those that are not shown as they are, shape (W,)."""
    for _ in range(_MOST_ROUNDS):
        square, determined = _determined(gram, slope, size, kinds)
        likely = np.maximum(np.sqrt(square / np.maximum(determined, 1e-12)), floor)
        before, size = size, np.where(shown, likely, size)
        if np.allclose(before, size, rtol=_AT_REST):
            break
    return size


def _determined(
    gram: Array, slope: Array, size: Array, kinds: NDArray[np.int64]
) -> tuple[Array, Array]:
    """Return each kind's sum of squares, and how many values of it are determined, (W,)."""
    n, variance = slope.size, np.tile(size**2, slope.shape[0])
    covariance = np.linalg.inv(gram.reshape(n, n) + np.diag(1.0 / variance))
    values = (covariance @ slope.ravel()).reshape(slope.shape)
    free = (1.0 - np.diag(covariance) / variance).reshape(slope.shape)
    alike = kinds[:, None] == kinds
    return alike @ np.sum(values**2, axis=0), alike @ np.sum(free, axis=0)


def _below(determined: Array, kinds: NDArray[np.int64]) -> Array:
    """Return the probability below which a deviation of so many values is taken, shape (W,)."""
    free = np.maximum(determined, 1.0)
    wider = student.isf(0.5 * _DAYS, free) / _NAMED
    odds = np.maximum(chi2.sf(free / wider**2, free), _PLAUSIBLY)
    return np.where(kinds == _GAIN, odds, _PLAUSIBLY)


def _plausible(
    gram: Array,
    slope: Array,
    size: Array,
    which: NDArray[np.bool_],
    floor: float,
    below: float,
) -> float:
    """Return what one kind's deviation is plausibly below, the others being as they are."""
    n = slope.size
    own = np.tile(which, slope.shape[0])
    known = np.where(own, 0.0, 1.0 / np.tile(size**2, slope.shape[0]))
    left, toward = beside(gram.reshape(n, n) + np.diag(known), slope.ravel(), own)
    power, ways = eigh(left)
    tried = np.geomspace(floor, _BEYOND, _TRIED)
    squares = tried[:, None] ** 2
    seen = 1.0 + squares * np.maximum(power, 0.0)
    explained = squares * (ways.T @ toward) ** 2 / seen
    likely = 0.5 * np.sum(explained - np.log(seen), axis=1)
    mass = np.cumsum(np.exp(likely - np.max(likely)))
    return float(np.interp(below * mass[-1], mass, tried))
