"""How plain runs are driven, what comes out of a draw, and the table of all."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.campaign_tables import share
from benchmarks.plain_runs import plan_deg

Array = NDArray[np.float64]

OUTSIDE, NOTHING = "outside", "nothing"


@dataclass(frozen=True, slots=True)
class Conditions:
    """How a motor is driven and measured.

    Parameters
    ----------
    kind, n, top_deg
        Of the plan: its kind, windows, largest phase.
    window_s
        Duration of a window.
    noise_rad_s, colour
        Standard deviation of the noise, and its correlation from window to window.
    n_references
        Healthy runs that the model is identified from.
    reference_kind
        Kind of their plan; empty for the run's own.
    sampled
        Whether speeds are read at the ends of windows, not averaged over them.
    """

    kind: str
    n: int
    top_deg: float
    window_s: float
    noise_rad_s: float
    colour: float
    n_references: int
    reference_kind: str = ""
    sampled: bool = False

    def phase_deg(self, rng: np.random.Generator) -> Array:
        """Return a run's phases, shape (n,).

        Parameters
        ----------
        rng
            Where chance comes from.
        """
        return plan_deg(self.kind, self.n, self.top_deg, rng)

    def reference_deg(self, rng: np.random.Generator) -> Array:
        """Return a reference's phases, shape (n,).

        Parameters
        ----------
        rng
            Where chance comes from.
        """
        return plan_deg(self.reference_kind or self.kind, self.n, self.top_deg, rng)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came out of a draw.

    Parameters
    ----------
    cause
        The cause that was hidden, "outside" or "nothing".
    times_noise
        Its root mean square over the noise's.
    conditions
        How the motor was driven.
    names
        What was named, each with its alternatives.
    verdict
        The verdict, or what a command said that ended with an error.
    """

    cause: str
    times_noise: float
    conditions: Conditions
    names: tuple[tuple[str, ...], ...]
    verdict: str

    @property
    def silent(self) -> bool:
        """Whether there was an answer, and no name in it."""
        return self.verdict in ("no_discrepancy", "unexplained")

    @property
    def right(self) -> bool:
        """Whether that is the answer one would wish."""
        if self.cause == NOTHING:
            return self.verdict == "no_discrepancy"
        if self.cause == OUTSIDE:
            return self.silent
        return bool(self.names) and self.names[0][0] == self.cause

    @property
    def in_set(self) -> bool:
        """Whether the cause is named or an alternative, or nothing where there is none to name."""
        if self.cause in (NOTHING, OUTSIDE):
            return self.silent
        return any(self.cause in names for names in self.names)


def report(outcomes: Sequence[Outcome]) -> None:
    """Print the tables.

    Parameters
    ----------
    outcomes
        Of the draws.
    """
    for times_noise in sorted({o.times_noise for o in outcomes}, reverse=True):
        print(f"\n{times_noise:g} x noise{'':28} right first        in the set")
        rows = [o for o in outcomes if o.times_noise == times_noise and o.cause != NOTHING]
        for cause in dict.fromkeys(o.cause for o in rows):
            _line(cause, [o for o in rows if o.cause == cause])
        known = [o for o in rows if o.cause != OUTSIDE]
        for n in sorted({o.conditions.n for o in known}):
            _line(f"of the library, {n} windows", [o for o in known if o.conditions.n == n])
        _by_kind("of the library, ", known)
        _line("all of the library", known)
    healthy = [o for o in outcomes if o.cause == NOTHING]
    print("\nnothing hidden" + " " * 22 + "said so            and nothing named")
    for n in sorted({o.conditions.n for o in healthy}):
        _line(f"{n} windows", [o for o in healthy if o.conditions.n == n])
    _by_kind("", healthy)
    _line("all", healthy)


def _by_kind(name: str, rows: Sequence[Outcome]) -> None:
    for other in (False, True):
        mine = [o for o in rows if bool(o.conditions.reference_kind) == other]
        _line(name + ("another" if other else "the same") + " plan", mine)
    for sampled in (False, True):
        mine = [o for o in rows if o.conditions.sampled == sampled]
        _line(name + ("samples" if sampled else "averages"), mine)


def _line(name: str, rows: Sequence[Outcome]) -> None:
    shares = [
        share(sum(hits), len(rows)) for hits in ([o.right for o in rows], [o.in_set for o in rows])
    ]
    shown = "  ".join(
        f"{100 * mean:5.1f} ({100 * low:3.0f}-{100 * high:3.0f} %)" for mean, low, high in shares
    )
    print(f"{name:32} {shown} of {len(rows)}")
