"""What a diagnosis says: everything that the JSON, the terminal and the report show."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from usmbench.model.hammerstein import HammersteinModel

Array = NDArray[np.float64]
Verdict = Literal["no_discrepancy", "explained", "partly_explained", "unexplained"]


@dataclass(frozen=True, slots=True)
class View:
    """The free-run residual against one quantity, before and after the extension.

    Parameters
    ----------
    versus
        Key of the quantity: time, phase, angle, direction, lag, speed, …
    label
        The quantity and its unit, for an axis.
    centre
        Middle of each bin, in the quantity's unit, shape (K,).
    before_rad_s, after_rad_s
        Mean residual of each bin without and with the extension, shape (K,).
    band_rad_s
        Half width of the band that the mean of a bin keeps within, all bins of the view together,
        in 95 % of runs that the model describes, shape (K,).
    n_windows
        Windows in each bin, shape (K,).
    excess_before, excess_after
        How far the view exceeds its band: 1 is at the band's edge, in the bin where it is farthest.
    """

    versus: str
    label: str
    centre: Array
    before_rad_s: Array
    after_rad_s: Array
    band_rad_s: Array
    n_windows: Array
    excess_before: float
    excess_after: float


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
    """

    name: str
    value: float
    low: float
    high: float
    unit: str

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
    """

    name: str
    form: str
    meaning: str
    mend: str
    alternatives: tuple[str, ...]
    parameters: tuple[Estimate, ...]
    p_value: float
    gain: float

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
        }


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
        Family-wise probability of such a drop where nothing is wrong.
    explained
        Share of the structure found in the residual that it removes, 0 … 1.
    parameters
        Its estimates, intervals left open where it was not refined.
    """

    name: str
    form: str
    meaning: str
    statistic: float
    n_parameters: int
    p_value: float
    explained: float
    parameters: tuple[Estimate, ...]


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
        The size; None where no size within the bounds would show.
    unit
        Unit.
    """

    cause: str
    parameter: str
    value: float | None
    unit: str


@dataclass(frozen=True, slots=True)
class Trace:
    """A run for plotting: at most a few thousand windows, evenly picked.

    Parameters
    ----------
    name
        The run.
    t_s, phase_deg
        Time and commanded phase, shape (K,).
    measured_rad_s, simulated_rad_s, extended_rad_s
        Speeds: measured, of the model as given, of the extended model, shape (K,).
    """

    name: str
    t_s: Array
    phase_deg: Array
    measured_rad_s: Array
    simulated_rad_s: Array
    extended_rad_s: Array


@dataclass(frozen=True, slots=True)
class Remainder:
    """What is left over.

    Parameters
    ----------
    versus
        Key of the view that shows it most clearly.
    says
        One sentence.
    """

    versus: str
    says: str


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """The whole result.

    Parameters
    ----------
    verdict
        The contract's verdict.
    causes
        Named causes, strongest first.
    candidates
        Every testable cause with its evidence, strongest first.
    not_testable
        (cause, why) for each cause that these runs cannot show.
    rmse_simulation_rad_s, rmse_extended_rad_s, noise_floor_rad_s
        Held-out, free-running.
    gain, gain_low, gain_high
        Share of the held-out mean square above the noise floor that the extension removes, with
        its 95 % interval.
    remainder
        What is left over, or None.
    minimum_detectable
        One entry a testable cause.
    views
        The residual's views, the one that exceeds its band most first.
    traces
        One a run.
    extended
        The model with the named causes; equal to the given one where none is named.
    n_windows
        Windows that were judged.
    warnings
        What the user ought to know, one sentence each.
    next_experiment
        ``{"says", "plan"}``, or None.
    """

    verdict: Verdict
    causes: tuple[NamedCause, ...]
    candidates: tuple[Candidate, ...]
    not_testable: tuple[tuple[str, str], ...]
    rmse_simulation_rad_s: float
    rmse_extended_rad_s: float
    noise_floor_rad_s: float
    gain: float
    gain_low: float
    gain_high: float
    remainder: Remainder | None
    minimum_detectable: tuple[Detectable, ...]
    views: tuple[View, ...]
    traces: tuple[Trace, ...]
    extended: HammersteinModel
    n_windows: int
    warnings: tuple[str, ...] = ()
    next_experiment: dict[str, Any] | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the mapping that ``diagnose --json`` writes."""
        left = self.remainder
        return {
            "verdict": self.verdict,
            "causes": [cause.to_json() for cause in self.causes],
            "rmse_rad_s": {
                "simulation": self.rmse_simulation_rad_s,
                "extended": self.rmse_extended_rad_s,
                "noise_floor": self.noise_floor_rad_s,
            },
            "gain": self.gain,
            "gain_interval": [self.gain_low, self.gain_high],
            "remainder": None if left is None else {"versus": left.versus, "says": left.says},
            "minimum_detectable": {
                d.cause: {"value": d.value, "unit": d.unit, "parameter": d.parameter}
                for d in self.minimum_detectable
            },
            "next_experiment": self.next_experiment,
            "not_testable": dict(self.not_testable),
            "n": self.n_windows,
            "warnings": list(self.warnings),
        }
