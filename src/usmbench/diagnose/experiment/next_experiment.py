"""The next experiment: the plan under which the causes that are left differ most.

T-optimality (Atkinson and Fedorov 1975, doi:10.1093/biomet/62.1.57): of all designs, take the one
that maximises the distance between the model taken as true and the best that its rival can do,
here for the pair that lies closest, each taken as true in turn. The distance is that of the
whitened problem, so that noise, the model's own uncertainty and what may wander from run to run
count; and the rival is fitted to the runs in hand and the new one together, as it will be.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from usmbench.diagnose.cutting.stretches import first_windows
from usmbench.diagnose.evidence import Candidate, Estimate, NamedCause
from usmbench.diagnose.experiment.experiment_menu import menu
from usmbench.diagnose.experiment.experiment_range import range_of
from usmbench.diagnose.experiment.proposal import Experiment, planned_record
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.huber_weights import robust_spread
from usmbench.diagnose.fitting.refining import refine
from usmbench.diagnose.known.knowledge import Knowledge
from usmbench.diagnose.naming.ranking import telling_deviance
from usmbench.diagnose.noise.noise_estimate import noise_as_stated
from usmbench.diagnose.noise.noise_model import Noise
from usmbench.diagnose.residual.own_effects import cut_beside_own, known_of, own_effects
from usmbench.diagnose.residual.own_gone import GONE
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.result import Diagnosis
from usmbench.model.applied import Applied
from usmbench.model.effects.registry import find_effect
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record

_MOST_RIVALS = 4
_MOST_WINDOWS = 12_000  # of the runs in hand: more cost time and hardly change the choice
_SUGGESTIVE = 0.2  # family-wise probability below which an effect is worth another run
_ENOUGH = 0.95
_WORTH = 0.05  # odds that an experiment must add
_LONGER = (2, 4)
_HELD_WINDOWS = 10
_LEAST_DISTANCE = 1e-3


@dataclass(frozen=True, slots=True)
class Question:
    """What the next experiment is to decide.

    Parameters
    ----------
    rivals
        The causes, each with its best values; None stands for no cause at all.
    given
        Causes that act beside any of them.
    """

    rivals: tuple[Applied | None, ...]
    given: tuple[Applied, ...] = ()

    @property
    def says(self) -> str:
        """What an experiment is for."""
        names = [rival.effect.name.replace("_", " ") for rival in self.rivals if rival is not None]
        if len(names) == 1:
            return f"To see whether there is any {names[0]}"
        return f"To decide between {', '.join(names[:-1])} and {names[-1]}"


def question_of(diagnosis: Diagnosis) -> Question | None:
    """Return what a diagnosis leaves open, or None where there is nothing to decide.

    Parameters
    ----------
    diagnosis
        The diagnosis.
    """
    # What the model has and the motor has not asks for no experiment: a look at the motor tells.
    causes = [cause for cause in diagnosis.causes if cause.form != GONE]
    candidates = [c for c in diagnosis.candidates if c.form != GONE]
    named = {cause.name for cause in diagnosis.causes}
    alone = {c.name: c for c in candidates if c.name not in named}
    # What strikes single windows is not what an experiment asks for first.
    for cause in sorted(causes, key=lambda c: _stated(c).effect.sporadic):
        others = [alone[name] for name in cause.alternatives if name in alone]
        if others:
            beside = [_stated(other) for other in causes if other is not cause]
            return Question(
                (_stated(cause), *map(_fitted, others))[:_MOST_RIVALS],
                tuple(applied for applied in beside if not applied.effect.sporadic),
            )
    if diagnosis.verdict != "no_discrepancy" or not candidates:
        return None
    best = min(candidates, key=lambda candidate: candidate.p_value)
    return Question((_fitted(best), None)) if best.p_value < _SUGGESTIVE else None


def propose(
    diagnosis: Diagnosis, records: Sequence[Record], model: HammersteinModel
) -> dict[str, Any] | None:
    """Return the experiment that decides best what a diagnosis leaves open.

    Parameters
    ----------
    diagnosis
        The diagnosis.
    records
        The runs it was made on.
    model
        The model it was made with.

    Returns
    -------
    dict or None
        ``says``, ``plan`` (a plan's document), ``odds_before`` and ``odds_after``: the probability
        that the true one of the two closest causes is told from the other, with these runs and
        with the new one beside them. None where nothing is open, where no drive frequency is
        known, or where no experiment would help.
    """
    question = question_of(diagnosis)
    where = range_of(model, records)
    if question is None or where is None:
        return None
    design = _Design(question, records, model)
    # These runs did not decide it, whatever the simulation promises: at most a guess is left.
    before = min(_odds(design.margin(None)), 1.0 / len(question.rivals))
    best, margin = _best(design, menu(where))
    chosen = best
    for times in _LONGER:
        if _odds(margin) >= _ENOUGH:
            break
        chosen = best.repeated(times)
        margin = design.margin(chosen)
    after = _odds(margin)
    if after < before + _WORTH:
        return None
    return {
        "says": f"{question.says}: {chosen.says}; {chosen.lasts(design.window_s)}.",
        "plan": chosen.plan.source.document,
        "odds_before": before,
        "odds_after": after,
    }


class _Design:
    """The runs in hand, and how far apart the rivals lie once another is added."""

    def __init__(self, question: Question, records: Sequence[Record], model: HammersteinModel):
        self._question, self._model = question, model
        self._own = own_effects(model)
        self._known: Knowledge = known_of(model)
        self.window_s = records[0].usual_window_s
        stretches, _ = cut_beside_own(records, model)
        self._stretches = first_windows(stretches, _MOST_WINDOWS)
        effects = (*(rival for rival in question.rivals[:1] if rival), *question.given)
        self._noise, self._spread = self._settled_noise(effects)

    def _settled_noise(self, effects: tuple[Applied, ...]) -> tuple[Noise, float]:
        """Noise and its spread, with the best guess taken out of the residual."""
        stretches = self._stretches
        uses = [s.use for s in stretches]
        rough = self._noise_of([s.residual_rad_s for s in stretches])
        problem = Problem(stretches, self._known, rough, uses, self._own)
        left = problem.left_rad_s(effects)
        noise = self._noise_of(left)
        problem = problem.weighed(noise, uses)
        return noise, robust_spread(problem, problem.carried(left))

    def _noise_of(self, residuals: Sequence[NDArray[np.float64]]) -> Noise:
        """Return the noise that the model knows, or that residuals show."""
        if self._known.noise is not None:
            return self._known.noise
        uses = [s.use for s in self._stretches]
        return noise_as_stated(self._stretches, residuals, uses, self._known.stated_rad_s)

    def margin(self, experiment: Experiment | None) -> float:
        """Return how far the closest two lie apart, with one more run or without."""
        stretches = list(self._stretches)
        if experiment is not None:
            record = planned_record(experiment.plan, self._model, self.window_s)
            new, _ = cut_beside_own([record], self._model)
            run = 1 + max(s.run for s in stretches)
            stretches += [replace(s, run=run) for s in new]
        uses = [s.use for s in stretches]
        problem = Problem(stretches, self._known, self._noise, uses, self._own)
        return min(
            self._apart(problem, truth, rival)
            for truth, rival in permutations(self._question.rivals, 2)
            if truth is not None
        )

    def _apart(self, problem: Problem, truth: Applied, rival: Applied | None) -> float:
        """Return by how many standard deviations the truth beats its rival clearly."""
        given = self._question.given
        as_true = problem.measuring(problem.change_rad_s((*given, truth)))
        start = (*given, *(() if rival is None else (rival,)))
        drop = refine(as_true, Fit(start, 0.0, 0.0)).statistic if start else 0.0
        distance = math.sqrt(max(as_true.deviance - drop, 0.0)) / self._spread
        needed = telling_deviance(as_true.deviance / self._spread**2)
        # The difference of two deviances is normal: mean distance², deviation 2·distance.
        return (distance**2 - needed) / (2.0 * max(distance, _LEAST_DISTANCE))


def _best(design: _Design, experiments: Sequence[Experiment]) -> tuple[Experiment, float]:
    """Return the experiment under which the closest two lie farthest apart, and how far.

    A model is surest of phases that are held, so those that hold theirs come first: of restless
    commands its runs taught it little.
    """
    held = [e.hold_windows >= _HELD_WINDOWS for e in experiments]
    margins = [
        design.margin(e) if holds else -math.inf for e, holds in zip(experiments, held, strict=True)
    ]
    if _odds(max(margins)) < _ENOUGH:
        margins = [
            known if holds else design.margin(e)
            for e, holds, known in zip(experiments, held, margins, strict=True)
        ]
    return max(zip(experiments, margins, strict=True), key=lambda pair: pair[1])


def _odds(margin: float) -> float:
    return float(norm.cdf(margin))


def _stated(cause: NamedCause) -> Applied:
    return _applied(cause.name, cause.form, cause.parameters)


def _fitted(candidate: Candidate) -> Applied:
    return _applied(candidate.name, candidate.form, candidate.parameters)


def _applied(name: str, form: str, parameters: Sequence[Estimate]) -> Applied:
    return Applied(find_effect(name, form), {p.name: p.value for p in parameters})
