"""Causes as a diagnosis shows them: what is named, the evidence for each, what would have shown."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

_PLAINLY_MORE = 2.0  # times the gain: less may come by chance, and the order of search stands


@dataclass(frozen=True, slots=True)
class Estimate:
    """One parameter of a cause with its 95 % interval.

    Parameters
    ----------
    name
        Its name, unit included.
    value, low, high
        Estimate and interval.
    unit
        Unit.
    what
        What it says of the motor or the bench; see `Parameter`.
    """

    name: str
    value: float
    low: float
    high: float
    unit: str
    what: str = ""

    def to_json(self) -> dict[str, Any]:
        """Return the mapping that the contract asks for."""
        return {"value": self.value, "low": self.low, "high": self.high, "unit": self.unit}


@dataclass(frozen=True, slots=True)
class NamedCause:
    """A cause that the diagnosis stands for.

    Parameters
    ----------
    name
        Name of the cause.
    form
        Which of the cause's forms fitted.
    meaning
        What it is physically, one sentence.
    mend
        What to look at on the bench, one sentence.
    alternatives
        Causes that these data cannot tell from it.
    parameters
        Its parameters.
    p_value
        Probability of evidence as strong for any cause of the library where nothing is wrong.
    gain
        Share of the held-out mean square above the noise floor that this cause removes.
    waves
        Amplitude and angle of those parameters that are a cosine and a sine of one quantity.
    single
        Whether it strikes single windows: no simulation foresees which.
    by_chance
        Whether windows count in which no simulation foresees what it does.
    """

    name: str
    form: str
    meaning: str
    mend: str
    alternatives: tuple[str, ...]
    parameters: tuple[Estimate, ...]
    p_value: float
    gain: float
    waves: tuple[Estimate, ...] = ()
    single: bool = False
    by_chance: bool = False

    def to_json(self) -> dict[str, Any]:
        """Return the mapping that the contract asks for."""
        return {
            "name": self.name,
            "form": self.form,
            "alternatives": list(self.alternatives),
            "parameters": {p.name: p.to_json() for p in self.parameters},
            "p_value": self.p_value,
            "gain": self.gain,
            "meaning": self.meaning,
            "mend": self.mend,
            "waves": {p.name: p.to_json() for p in self.waves},
        }


def strongest_first(causes: Sequence[NamedCause]) -> list[NamedCause]:
    """Return causes as the search found them, but one first that plainly gains most.

    Parameters
    ----------
    causes
        In the order in which they earned their names.
    """
    if not causes:
        return []
    strongest = max(causes, key=lambda cause: cause.gain)
    if strongest.gain <= _PLAINLY_MORE * causes[0].gain:
        return list(causes)
    return [strongest, *(cause for cause in causes if cause is not strongest)]


@dataclass(frozen=True, slots=True)
class Candidate:
    """The evidence for one cause of the library, alone.

    Parameters
    ----------
    name, form
        The cause, and its best form.
    meaning
        What it is physically, one sentence.
    statistic
        Drop of the deviance (whitened sum of squares) that it brings.
    n_parameters
        Parameters it takes.
    p_value
        Family-wise probability of such a drop, less the misfit, where nothing is wrong.
    explained
        Share of the structure found in the residual that it removes, 0 … 1.
    parameters
        Its estimates, intervals left open where it was not refined.
    misfit
        What of the statistic does not speak for it; see `Ranked`.
    """

    name: str
    form: str
    meaning: str
    statistic: float
    n_parameters: int
    p_value: float
    explained: float
    parameters: tuple[Estimate, ...]
    misfit: float = 0.0


@dataclass(frozen=True, slots=True)
class Detectable:
    """The smallest size of a cause that these runs would have shown at 90 % power.

    Parameters
    ----------
    cause
        Name of the cause.
    parameter
        The parameter that states its size.
    value
        The size.
    unit
        Unit.
    """

    cause: str
    parameter: str
    value: float
    unit: str
