"""What is left in one span of the runs only, though its phases come elsewhere as well.

What acts there came or went. No view of phase, speed or angle says so, though some show it.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.result import Remainder
from usmbench.model.applied import Applied

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]

# Nothing measured sets these.
_WIDTH_DEG = 12.0  # of like phases
_FEWEST_ROWS, _MOST_PARTS = 10, 48  # of a part; of a run
_MOST_OF_ROW = 25.0  # five times the noise: a few windows far out are no part
_ROUNDS = 5
_LEAST, _WHOLE = 0.1, 0.9  # of the rows: either side; of a run
_HALF = 0.5  # between a part that shows all of it and one that shows none
_MOSTLY, _HARDLY = 0.8, 0.2  # of what is left; of what like rows would leave elsewhere
_PLAIN = 15.0  # standard deviations of chance that they would, of the span that shows most


@dataclass(frozen=True, slots=True)
class _Rows:
    """Rows that count, end to end, shape (N,) each.

    Parameters
    ----------
    excess
        Square of what is left, over the noise's, less 1.
    kind
        Which have like phases, reached the same way.
    part
        Which part each is in: some rows that follow each other in a run.
    run, t_s
        Of which run they are, and when.
    """

    excess: Array
    kind: Numbers
    part: Numbers
    run: Numbers
    t_s: Array

    @classmethod
    def of(cls, problem: Problem, effects: Sequence[Applied]) -> "_Rows":
        """Return the rows of a problem, with effects taken out."""

        def of_rows(column: Callable[[Stretch], Array]) -> Array:
            pairs = zip(problem.stretches, problem.valid, strict=True)
            return np.concatenate([column(s)[valid] for s, valid in pairs])

        left = problem.left(effects)[: problem.n_rows]
        phase = of_rows(lambda s: np.round(s.context.phase_deg / _WIDTH_DEG))
        reached = np.column_stack([phase, of_rows(lambda s: s.direction)])
        kind = np.unique(reached, axis=0, return_inverse=True)[1].ravel()
        run = of_rows(lambda s: np.full(s.context.n, float(s.run))).astype(np.intp)
        excess = np.minimum(left**2, _MOST_OF_ROW) - 1.0
        return cls(excess, kind, _parts(run), run, of_rows(lambda s: s.context.t_s))

    def would(self, loud: Mask) -> Array:
        """Return the mean excess of like rows among loud ones, shape (N,); NaN for none."""
        n = np.bincount(self.kind[loud], minlength=self.kind.max() + 1)
        sums = np.bincount(self.kind[loud], self.excess[loud], n.size)
        mean = np.divide(sums, n, out=np.full(n.size, np.nan), where=n > 0)
        return np.asarray(mean[self.kind])


def confined(problem: Problem, effects: Sequence[Applied]) -> Remainder | None:
    """Say where nearly all of what effects leave is, if that is in one span of the runs only.

    Parameters
    ----------
    problem
        The problem.
    effects
        The effects to take out.

    Returns
    -------
    Remainder or None
        None where it is everywhere, or where phases that show it come there only.
    """
    rows = _Rows.of(problem, effects)
    loud = _loud(rows)
    share = float(np.mean(loud))
    mostly = np.sum(rows.excess[loud]) > _MOSTLY * np.sum(rows.excess)
    if not (_LEAST < share < 1.0 - _LEAST and mostly and _is_quiet(rows, ~loud)):
        return None
    names = {s.run: s.name for s in problem.stretches}
    places = list(_places(rows, loud, names))
    versus = "run" if all(place in names.values() for place in places) else "time"
    what = "what is left" if effects else "what is off"
    return Remainder(
        versus,
        f"nearly all of {what} is in {' and '.join(places)}, and at the same phases elsewhere "
        "there is hardly any: look for what was different then",
    )


def _parts(run: Numbers) -> Numbers:
    """Return which part of its run each row is in, shape (N,)."""
    parts, n_before = [], 0
    for n in np.unique(run, return_counts=True)[1].tolist():
        n_parts = int(np.clip(n // _FEWEST_ROWS, 1, _MOST_PARTS))
        parts.append(n_before + np.arange(n) * n_parts // n)
        n_before += n_parts
    return np.concatenate(parts)


def _loud(rows: _Rows) -> Mask:
    """Return the rows of the span of parts that shows something, shape (N,)."""
    loud = np.ones(rows.excess.size, dtype=np.bool_)
    for _ in range(_ROUNDS):
        would = rows.would(loud)
        would = np.maximum(np.where(np.isnan(would), np.mean(rows.excess[loud]), would), 0.0)
        beyond = np.bincount(rows.part, rows.excess - _HALF * would)
        before, loud = loud, _span(beyond.astype(np.float64))[rows.part]
        if not loud.any() or np.all(loud == before):
            break
    return loud


def _span(beyond: Array) -> Mask:
    """Return the span of parts that holds the largest sum, shape (P,)."""
    sums = np.append(0.0, np.cumsum(beyond))
    end = int(np.argmax(sums[1:] - np.minimum.accumulate(sums[:-1]))) + 1
    start = int(np.argmin(sums[:end]))
    parts = np.arange(beyond.size)
    return np.asarray((parts >= start) & (parts < end))


def _is_quiet(rows: _Rows, quiet: Mask) -> bool:
    """Whether some rows show hardly any of what the like of them show elsewhere."""
    would = rows.would(~quiet)
    compared = quiet & np.isfinite(would)
    most, does = float(np.sum(would[compared])), float(np.sum(rows.excess[compared]))
    chance = float(np.sqrt(2.0 * np.count_nonzero(compared)))
    return most > _PLAIN * chance and does < _HARDLY * most


def _places(rows: _Rows, loud: Mask, names: dict[int, str]) -> Iterator[str]:
    """Yield where loud rows are: the name of a run, or times of it."""
    for run, name in names.items():
        own = rows.run == run
        t_s = rows.t_s[own & loud]
        if not t_s.size:
            continue
        if t_s.size > _WHOLE * np.count_nonzero(own):
            yield name
        else:
            yield f"{t_s[0]:.3g} to {t_s[-1]:.3g} s" + (f" of {name}" if len(names) > 1 else "")
