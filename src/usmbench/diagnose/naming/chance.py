"""Where causes that act by chance may strike, and whether there is the scatter that they leave."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Mask
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied

Array = NDArray[np.float64]

_SLOWER = 0.8  # times the least speed at which such a cause is seen to act
_ELSEWHERE = 0.1  # of the scatter
_ENOUGH = 0.5  # of the least scatter
_SHOWS = 2.0  # standard deviations of a sum of squares: less of it shows in no run
_FORETOLD = 0.5  # of the scatter: most of it is no chance then
_LIKELY = 2.0  # deviations of what is no news
_FEWEST_ALIKE, _MOST_GROUPS = 10, 20  # windows of about one speed, lest chance seem foretold


def chancy_of(effects: Sequence[Applied]) -> list[Applied]:
    """Return those of some effects that act by chance.

    Parameters
    ----------
    effects
        The effects.
    """
    return [a for a in effects if a.effect.by_chance]


def struck_by(problem: Problem, chancy: Sequence[Applied]) -> list[Mask]:
    """Return the rows fast enough for what acts from some speed on, and those beside.

    By chance it acts below the speed that fits best, too, and an eccentric disc turns faster now
    and then than the shaft.

    Parameters
    ----------
    problem
        The problem.
    chancy
        The causes, as they were fitted.

    Returns
    -------
    rows
        One mask a stretch, shape (N,).
    """
    speeds = [np.abs(s.simulated_rad_s) for s in problem.stretches]
    acts = [
        np.abs(change) > problem.noise.level_rad_s(stretch)
        for change, stretch in zip(problem.change_rad_s(chancy), problem.stretches, strict=True)
    ]
    slowest = min(float(np.min(v[a], initial=np.inf)) for v, a in zip(speeds, acts, strict=True))
    return [np.convolve(v >= _SLOWER * slowest, np.ones(3), "same") > 0.0 for v in speeds]


def leaves_scatter(problem: Problem, effects: Sequence[Applied]) -> bool:
    """Return whether what effects leave is the scatter of those that act by chance.

    Counts that are lost now and then, say: no simulation foresees which. Then the scatter sits in
    the windows that may be struck, there the motor only ever seems too slow, and the speed does not
    say by how much.

    Parameters
    ----------
    problem
        The problem.
    effects
        All that is named, as it was fitted.
    """
    chancy = chancy_of(effects)
    if not chancy:
        return False
    left_rad_s = problem.left_rad_s(effects)
    day_rad_s = _likely_rad_s(problem, left_rad_s)
    changes, struck = problem.change_rad_s(chancy), struck_by(problem, chancy)
    unstruck_rad_s = problem.left_rad_s([a for a in effects if a not in chancy])
    outside = against = 0.0
    left_inside, speeds_rad_s = [], []
    for k, (stretch, mask) in enumerate(zip(problem.stretches, problem.masks, strict=True)):
        level = problem.noise.level_rad_s(stretch)
        left = (left_rad_s[k] - day_rad_s[k]) / level
        was = (unstruck_rad_s[k] - day_rad_s[k]) / level
        inside = mask & struck[k]
        outside += _beyond_noise(left[mask & ~struck[k]])
        against += _beyond_noise(was[inside & (was * changes[k] < 0.0)])
        left_inside.append(left[inside])
        speeds_rad_s.append(stretch.simulated_rad_s[inside])
    scattered = np.concatenate(left_inside)
    scatter = _beyond_noise(scattered)
    if max(outside, against) >= _ELSEWHERE * scatter:
        return False
    return _foretold(scattered, np.concatenate(speeds_rad_s)) < _FORETOLD * scatter


def _likely_rad_s(problem: Problem, left_rad_s: Sequence[Array]) -> list[Array]:
    """Return what of a residual is most likely another day's, by stretch, as far as days go."""
    most_rad_s = problem.unsure_rad_s([s.use for s in problem.stretches])
    departed_rad_s = problem.departed_rad_s(left_rad_s)
    return [
        np.clip(departed, -_LIKELY * most, _LIKELY * most)
        for departed, most in zip(departed_rad_s, most_rad_s, strict=True)
    ]


def _beyond_noise(values: Array) -> float:
    """Sum of squares beyond that of a noise of 1."""
    return float(values @ values) - values.size


def _foretold(values: Array, speed_rad_s: Array) -> float:
    """Sum of squares of what the speed alone, and which way the motor turns, says of values."""
    n_groups = int(np.clip(values.size // _FEWEST_ALIKE, 1, _MOST_GROUPS))
    groups = np.array_split(values[np.argsort(speed_rad_s, kind="stable")], n_groups)
    return sum(float(np.sum(group)) ** 2 / group.size for group in groups)


def scatters(problem: Problem, effects: Sequence[Applied]) -> bool:
    """Return whether the windows that the last effect acts on scatter as much as chance leaves.

    A counter loses whole counts. Where the mean loss is a count and a part f, some windows lose one
    more than others, and the square of their scatter is no less than f (1 − f) counts². Of counts
    far smaller than the noise none shows.

    Parameters
    ----------
    problem
        The problem. Runs that do not say how large a count is may scatter as they like.
    effects
        The effects, as they were fitted; the last acts by chance. Of what acts on something other
        than the counter nothing is asked.
    """
    if effects[-1].effect.stage != "counter":
        return True
    # Neither weights nor masks: they are there to keep scatter from the fit.
    plain = problem.weighed(problem.noise, [s.use for s in problem.stretches])
    acts, least = [], 0.0
    for k, change in enumerate(plain.change_rad_s(effects[-1:])):
        count_rad_s, valid = plain.stretches[k].context.count_rad_s, plain.valid[k]
        if count_rad_s is None:
            return True
        level = plain.noise.level_rad_s(plain.stretches[k])[valid]
        part = np.abs(change[valid]) / count_rad_s % 1.0
        least += float(np.sum(part * (1.0 - part) * (count_rad_s / level) ** 2))
        acts.append(change[valid] != 0.0)
    left = plain.left(effects)[: plain.n_rows][np.concatenate(acts)]
    least *= _ENOUGH
    return least < _SHOWS * np.sqrt(2.0 * left.size) or _beyond_noise(left) > least
