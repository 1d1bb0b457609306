"""From runs and a model to a diagnosis."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from usmbench.diagnose.anew.identify_anew import identified_anew
from usmbench.diagnose.cutting.check_runs import check_moves
from usmbench.diagnose.cutting.command_times import (
    any_moment_s,
    at_unknown_moments,
    unknown_moments,
)
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.one_angle import at_models_angle, at_one_angle
from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.evidence import Candidate, Estimate, NamedCause, strongest_first
from usmbench.diagnose.fitting.fit import NOTHING, Fit
from usmbench.diagnose.fitting.gain import Gain, held_out_gain
from usmbench.diagnose.fitting.intervals import intervals
from usmbench.diagnose.known.knowledge import knowledge_of
from usmbench.diagnose.naming.detectable import smallest_sizes
from usmbench.diagnose.naming.found import (
    Found,
    left_aside,
    on_nothing_named,
    unmeasured,
    verdict_on,
)
from usmbench.diagnose.naming.ranking import Ranked, alternatives
from usmbench.diagnose.naming.remainder import describe
from usmbench.diagnose.naming.search import search
from usmbench.diagnose.naming.sporadic import Sporadic, find_sporadic, left_unnamed
from usmbench.diagnose.residual.form import doubting_own
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.views import residual_views
from usmbench.diagnose.result import Diagnosis, Trace, Verdict
from usmbench.model.effects.base import Effect
from usmbench.model.effects.registry import library
from usmbench.model.extended import Applied, applied_effects
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record

_MOST_POINTS = 3000


def diagnose(records: Sequence[Record], model: HammersteinModel) -> Diagnosis:
    """Find out where runs and a model part, and why.

    Parameters
    ----------
    records
        Measured runs of one motor, at least one.
    model
        The model.

    Raises
    ------
    usmbench.errors.InputError
        Runs that do not belong to the model or together, or too short to say anything.
    """
    stretches, warnings = _cut(records, model)
    for run, record in enumerate(records):
        check_moves(record, [s.simulated_rad_s for s in stretches if s.run == run])
    anew = identified_anew(stretches, model, library())
    if anew is None:
        return _diagnosed(stretches, warnings, model)
    # Fitted beside its effect, such a model is not in doubt for it.
    again, _ = cut_runs(records, anew.model, own_effects(anew.model))
    return anew.told(_diagnosed(again, warnings, anew.model))


def _cut(records: Sequence[Record], model: HammersteinModel) -> tuple[list[Stretch], list[str]]:
    """Cut runs, and doubt the effects by which the model was extended."""
    own = own_effects(model)
    stretches, warnings = cut_runs(records, model, own)
    doubted = own[: len(model.effects)]
    stretches, told = at_models_angle(stretches, own) if doubted else at_one_angle(stretches)
    return doubting_own(stretches, own, doubted), [*warnings, *told]


def own_effects(model: HammersteinModel) -> tuple[Applied, ...]:
    """Return a model's effects, and what healthy runs are known to show.

    Parameters
    ----------
    model
        The model.
    """
    return (*applied_effects(model.effects), *applied_effects(knowledge_of(model).habits))


def searched(stretches: Sequence[Stretch], model: HammersteinModel) -> Found:
    """Return what a search for causes comes to, those of single windows aside.

    Parameters
    ----------
    stretches
        The runs, cut with `own_effects` of the model.
    model
        The model.
    """
    contexts = [s.context for s in stretches]
    effects = [e for e in library() if not e.sporadic and e.untestable(contexts) is None]
    known = knowledge_of(model)
    late_s = max(known.wander.late_s, any_moment_s(stretches))
    known = replace(known, wander=replace(known.wander, late_s=late_s))
    marked = at_unknown_moments(stretches, late_s)
    return search(marked, known, own_effects(model), effects)


def _diagnosed(
    stretches: Sequence[Stretch], warnings: Sequence[str], model: HammersteinModel
) -> Diagnosis:
    """Diagnose a model that is taken for what it says."""
    contexts = [s.context for s in stretches]
    reasons = {(e.name, e.form): e.untestable(contexts) for e in library()}
    testable = [e for e in library() if reasons[e.name, e.form] is None]
    refused: dict[str, str] = {}
    for (name, _), reason in reasons.items():
        if reason is not None and all(e.name != name for e in testable):
            refused[name] = reason
    found = searched(stretches, model)
    sporadic = find_sporadic(found.problem, found.fit.effects, found.spread)
    if sporadic is not None and sporadic.named.name in {r[0].effect.name for r in found.named}:
        sporadic = None
    says = verdict_on(found, sporadic)
    told = (*warnings, *unknown_moments(found.problem.stretches), *unmeasured(found))
    return _report(found, sporadic, says, model, testable, tuple(refused.items()), told)


def _report(
    found: Found,
    sporadic: Sporadic | None,
    says: Verdict,
    model: HammersteinModel,
    testable: Sequence[Effect],
    refused: tuple[tuple[str, str], ...],
    warnings: tuple[str, ...],
) -> Diagnosis:
    """Put everything together."""
    stands = says in ("explained", "partly_explained")
    named = found.named if stands else []
    # The problem is that of a motor that shows what was named, also where no name stands.
    problem = found.problem.showing(()) if found.named and not named else found.problem
    fit = found.fit if named else NOTHING
    sporadic = sporadic if stands else None
    struck = () if sporadic is None else sporadic.struck
    gain = held_out_gain(problem, fit, struck)
    if named and gain.worse:
        says = on_nothing_named(found)
        return _report(found, None, says, model, testable, refused, warnings)
    if sporadic is None:
        warnings += tuple(left_unnamed(problem, fit.effects, found.spread))
    if says == "no_discrepancy":
        warnings += tuple(left_aside(found))
    effects = (*fit.effects, *(() if sporadic is None else (sporadic.applied,)))
    extended = replace(
        model, effects=(*model.effects, *(applied.to_mapping() for applied in effects))
    )
    left = found.left_rad_s if named else problem.residual_rad_s
    causes = [] if not named else _causes(found, named, fit, gain, struck)
    if sporadic is not None:
        most = max((ranking[0].statistic for ranking in named), default=0.0)
        strongest = sporadic.deviance > most * found.spread**2
        causes.insert(0 if strongest else len(causes), sporadic.named)
    views = residual_views(problem, left, found.spread)
    remainder = None if says in ("no_discrepancy", "explained") else describe(views, found.spread)
    return Diagnosis(
        verdict=says,
        causes=tuple(causes),
        candidates=tuple(_candidate(r, found) for r in _best_forms(found.ranked)),
        not_testable=refused,
        rmse_simulation_rad_s=gain.rmse_simulation_rad_s,
        rmse_extended_rad_s=gain.rmse_extended_rad_s,
        noise_floor_rad_s=gain.noise_floor_rad_s,
        gain=gain.gain if effects else 0.0,
        gain_low=gain.low if effects else 0.0,
        gain_high=gain.high if effects else 0.0,
        remainder=remainder,
        minimum_detectable=smallest_sizes(problem, testable, found.spread),
        views=views,
        traces=tuple(_traces(problem, fit)),
        extended=extended,
        n_windows=problem.n_rows,
        warnings=warnings,
    )


def _causes(
    found: Found, named: Sequence[list[Ranked]], fit: Fit, gain: Gain, struck: Sequence[Mask]
) -> list[NamedCause]:
    """Describe the named causes, the strongest first."""
    problem = found.problem
    ranges = intervals(problem, fit, found.spread)
    causes = []
    for k, (ranking, applied) in enumerate(zip(named, fit.effects, strict=True)):
        share = gain.gain
        if len(named) > 1:
            rest = Fit(tuple(a for i, a in enumerate(fit.effects) if i != k), 0.0, 0.0)
            share = max(gain.gain - held_out_gain(problem, rest, struck).gain, 0.0)
        effect = applied.effect
        causes.append(
            NamedCause(
                effect.name,
                effect.form,
                effect.meaning,
                effect.mend,
                alternatives(ranking),
                _estimates(applied, ranges[k]),
                ranking[0].p_value,
                share,
            )
        )
    return strongest_first(causes)


def _estimates(applied: Applied, ranges: dict[str, tuple[float, float]]) -> tuple[Estimate, ...]:
    """Describe the parameters."""
    found = []
    for p in applied.effect.parameters:
        value = applied.values[p.name]
        low, high = ranges.get(p.name, (p.low, p.high))
        found.append(Estimate(p.name, value, min(low, value), max(high, value), p.unit))
    return tuple(found)


def _best_forms(ranked: Sequence[Ranked]) -> list[Ranked]:
    """Keep the best form of every cause."""
    best: dict[str, Ranked] = {}
    for r in ranked:
        best.setdefault(r.effect.name, r)
    return list(best.values())


def _candidate(r: Ranked, found: Found) -> Candidate:
    """Describe a cause of the library."""
    basis_share = min(r.statistic / max(found.before.excess, r.statistic, 1e-12), 1.0)
    return Candidate(
        r.effect.name,
        r.effect.form,
        r.effect.meaning,
        r.statistic,
        len(r.effect.parameters),
        r.p_value,
        basis_share,
        _estimates(r.fit.effects[-1], {}),
    )


def _traces(problem: Problem, fit: Fit) -> list[Trace]:
    """Thin each stretch out for plotting."""
    changes = problem.change_rad_s(fit.effects)
    traces = []
    for stretch, change in zip(problem.stretches, changes, strict=True):
        rows = np.unique(
            np.linspace(0, stretch.context.n - 1, min(stretch.context.n, _MOST_POINTS)).astype(int)
        )
        traces.append(
            Trace(
                stretch.name,
                stretch.context.t_s[rows],
                stretch.context.phase_deg[rows],
                stretch.speed_rad_s[rows],
                stretch.simulated_rad_s[rows],
                (stretch.simulated_rad_s + change)[rows],
            )
        )
    return traces
