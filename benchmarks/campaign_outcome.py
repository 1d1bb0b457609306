"""What came out of one draw of the naming campaign."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from benchmarks.campaign_draws import Hidden


@dataclass(slots=True)
class Outcome:
    """What came out of one draw; one line of the campaign's record.

    Parameters
    ----------
    motor, number
        Which draw.
    hidden
        What was hidden.
    plan, duration_s, correlation_s, wander, wire, n_frequencies
        Under which conditions.
    strength
        Root of the deviance a window that what was hidden has, given the noise and the wander of
        the gain, but for the ten windows in which it shows most.
    weakest
        The same of the smaller one of two causes.
    rms
        Plain ratio of root mean squares, of what was hidden and of the noise.
    told
        Length of a small effect to a test that is told its form; None where it was not asked.
    verdict, named, p_values, alternatives, remainder
        What diagnose said.
    gain
        The held-out gain that it claims; None where it names nothing.
    fresh_gain
        The gain of the extended model on another run.
    oracle_gain
        The gain there of the identified model with the hidden effect, known exactly, added to it.
    intervals
        Parameters whose truth is known: name to truth, low, value, high.
    error
        What the command complained of, where it failed.
    """

    motor: int
    number: int
    hidden: Hidden
    plan: str
    duration_s: float
    correlation_s: float
    wander: float
    wire: bool
    n_frequencies: int = 1
    strength: float = 0.0
    weakest: float = 0.0
    rms: float = 0.0
    told: float | None = None
    verdict: str = ""
    named: list[str] = field(default_factory=list)
    p_values: list[float] = field(default_factory=list)
    alternatives: list[str] = field(default_factory=list)
    gain: float | None = None
    fresh_gain: float | None = None
    oracle_gain: float | None = None
    intervals: dict[str, list[float]] = field(default_factory=dict)
    remainder: str = ""
    error: str = ""

    @property
    def judgement(self) -> str:
        """What the outcome is called in the table."""
        if self.error:
            return "error"
        if not self.named:
            return self.verdict
        wanted, known = set(self.hidden.causes), {*self.named, *self.alternatives}
        if self.hidden.group == "two":
            if wanted <= known:
                return "right" if wanted <= set(self.named) else "in the set"
            return "one of two" if wanted & known else "wrong"
        if self.named[0] in wanted:
            return "right" if len(self.named) == 1 else "right, and more"
        return "in the set" if wanted & known else "wrong"

    def line(self) -> str:
        """Return the record's line."""
        return json.dumps({**asdict(self), "judgement": self.judgement}, ensure_ascii=False)

    def take(self, found: dict[str, Any], frequencies_hz: Sequence[float]) -> None:
        """Keep what the campaign counts of a diagnosis.

        Parameters
        ----------
        found
            The diagnosis, as `--json` has it.
        frequencies_hz
            Drive frequencies of the run.
        """
        self.verdict = found["verdict"]
        self.named = [cause["name"] for cause in found["causes"]]
        self.p_values = [cause["p_value"] for cause in found["causes"]]
        self.alternatives = [a for cause in found["causes"] for a in cause["alternatives"]]
        self.gain = found["gain"] if found["causes"] else None
        self.remainder = "" if found["remainder"] is None else found["remainder"]["versus"]
        if not self.named or self.named[0] not in self.hidden.causes:
            return
        estimates = found["causes"][0]["parameters"]
        for name, truth in self.hidden.truth(frequencies_hz).items():
            if name in estimates:
                e = estimates[name]
                self.intervals[name] = [truth, e["low"], e["value"], e["high"]]
