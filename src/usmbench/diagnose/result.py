"""What a diagnosis says: everything that the JSON, the terminal and the report show."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.evidence import Candidate, Detectable, NamedCause
from usmbench.model.hammerstein import HammersteinModel

Array = NDArray[np.float64]
Verdict = Literal["no_discrepancy", "explained", "partly_explained", "unexplained"]
STANDS: tuple[Verdict, ...] = ("explained", "partly_explained")
"""What is said of names that stand."""


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
class LoneView:
    """Windows that stand alone, against what sets those of a cause apart.

    Parameters
    ----------
    cause
        Name of the cause.
    label
        The quantity and its unit, for an axis.
    at
        The quantity in each of the windows, shape (K,).
    off_rad_s
        By how much more than in the windows beside it each measured speed is off, shape (K,).
    rivals
        Each other cause of single windows, and by how much less likely it makes these: twice the
        difference of the log-likelihoods.
    """

    cause: str
    label: str
    at: Array
    off_rad_s: Array
    rivals: tuple[tuple[str, float], ...]


@dataclass(frozen=True, slots=True)
class Trace:
    """A run for plotting: at most a few thousand windows, evenly picked.

    Parameters
    ----------
    name
        The run.
    t_s
        Time, shape (K,).
    measured_rad_s, simulated_rad_s, extended_rad_s
        Speeds: measured, of the model as given, of the extended model, shape (K,).
    """

    name: str
    t_s: Array
    measured_rad_s: Array
    simulated_rad_s: Array
    extended_rad_s: Array


@dataclass(frozen=True, slots=True)
class Remainder:
    """What is left over.

    Parameters
    ----------
    versus
        Key of the view that shows it most clearly; "noise" where windows scatter without a pattern,
        "time" where no view by itself shows it.
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
        One entry a cause that would show within its bounds.
    views
        The residual's views, the one that exceeds its band most first.
    traces
        One a stretch of a run.
    extended
        The model with the named causes; equal to the given one where none is named.
    n_windows
        Windows that were judged.
    warnings
        What the user ought to know, one sentence each.
    lone_views
        One for each place or cause of single windows that is named.
    left_over
        The rms of what the extended model leaves, over that which the model's own runs show.
    next_experiment
        ``{"says", "plan", "odds_before", "odds_after"}``, or None.
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
    lone_views: tuple[LoneView, ...] = ()
    left_over: float = 1.0
    next_experiment: dict[str, Any] | None = None

    @property
    def foretells(self) -> bool:
        """Whether a simulation can follow one of the causes."""
        return any(not cause.single for cause in self.causes)

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
