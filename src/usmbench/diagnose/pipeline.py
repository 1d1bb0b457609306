"""From runs and a model to a diagnosis."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from usmbench.diagnose.anew.identify_anew import identified_anew
from usmbench.diagnose.cutting.check_runs import FEWEST_WINDOWS, check_moves
from usmbench.diagnose.cutting.command_times import (
    any_moment_s,
    at_unknown_moments,
    unknown_moments,
)
from usmbench.diagnose.cutting.long_runs import long_warming
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.evidence import Candidate, Estimate, NamedCause, strongest_first
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.foretold import foretells_nothing, foretold_rad_s
from usmbench.diagnose.fitting.gain import Gain, held_out_gain
from usmbench.diagnose.fitting.intervals import intervals
from usmbench.diagnose.fitting.wave_sizes import wave_sizes
from usmbench.diagnose.naming.began_warm import WarmStart, warm_warnings
from usmbench.diagnose.naming.beside_verdict import said_beside
from usmbench.diagnose.naming.detectable import smallest_sizes
from usmbench.diagnose.naming.found import (
    Found,
    verdict_on,
)
from usmbench.diagnose.naming.ranking import Ranked, alternatives
from usmbench.diagnose.naming.remainder import LOUD, describe
from usmbench.diagnose.naming.search import search
from usmbench.diagnose.naming.sporadic import Sporadic, find_sporadic, left_unnamed
from usmbench.diagnose.residual.own_effects import cut_beside_own, known_of, own_effects
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.views import residual_views
from usmbench.diagnose.residual.whole import PLAINLY
from usmbench.diagnose.result import Diagnosis, Trace, Verdict
from usmbench.model.effects.base import Effect
from usmbench.model.effects.registry import library
from usmbench.model.extended import Applied
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.pauses import cold_starts
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
    records = [part for record in records for part in cold_starts(record, FEWEST_WINDOWS)]
    stretches, warnings = cut_beside_own(records, model)
    for run, record in enumerate(records):
        check_moves(record, [s.simulated_rad_s for s in stretches if s.run == run])
    anew = identified_anew(stretches, model, library())
    if anew is None:
        return _diagnosed(stretches, warnings, model)
    # Fitted beside its effect, such a model is not in doubt for it.
    again, warnings = cut_beside_own(records, anew.model, doubted=False)
    return anew.told(_diagnosed(again, warnings, anew.model))


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
    known = known_of(model)
    late_s = max(known.wander.late_s, any_moment_s(stretches))
    known = replace(known, wander=replace(known.wander, late_s=late_s))
    marked, own = at_unknown_moments(stretches, late_s), own_effects(model)
    found = search(marked, known, own, effects)
    if verdict_on(found, None) == "no_discrepancy":
        return found
    start = WarmStart.of(found)
    names = start.names
    if not names:
        return found
    warm = search(marked, replace(known, began_warm=names), own, effects)
    return warm if start.tells_more(warm) else found


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
    held = _held(searched(stretches, model))
    return _report(held, model, testable, tuple(refused.items()), warnings)


@dataclass(frozen=True, slots=True)
class _Held:
    """What was found, as far as it stands and predicts rows that its fit has not seen."""

    found: Found
    verdict: Verdict
    sporadic: Sporadic | None
    gain: Gain


def _held(found: Found) -> _Held:
    """Judge what was found, and once more without the names where they gain nothing."""
    sporadic = find_sporadic(found.problem, found.fit.effects, found.spread)
    if sporadic is not None and sporadic.named.name in {r[0].effect.name for r in found.named}:
        sporadic = None
    says = verdict_on(found, sporadic)
    stands = says in ("explained", "partly_explained")
    if not stands:
        found, sporadic = found.without_names, None
    scattered = found.scattered
    if scattered is not found and scattered.after.p_value > PLAINLY:
        says = "explained"
    foretold = foretold_rad_s(scattered.problem, scattered.fit)
    if found.named and foretells_nothing(scattered.problem, foretold):
        return _held(found.without_names)
    gain = held_out_gain(scattered.problem, foretold, alone=sporadic is not None)
    return _Held(scattered, says, sporadic, gain)


def _report(
    held: _Held,
    model: HammersteinModel,
    testable: Sequence[Effect],
    refused: tuple[tuple[str, str], ...],
    warnings: Sequence[str],
) -> Diagnosis:
    """Put everything together."""
    found, gain = held.found, held.gain
    problem, fit = found.problem, found.fit
    singles = () if held.sporadic is None else (held.sporadic.applied,)
    effects = [applied.to_mapping() for applied in (*fit.effects, *singles)]
    views = residual_views(problem, found.left_rad_s, found.spread)
    says = held.verdict
    shown = max(view.excess_after for view in views)
    if says == "explained" and min(shown, gain.left_over) > LOUD:
        says = "partly_explained"
    silent = says in ("no_discrepancy", "explained")
    return Diagnosis(
        verdict=says,
        causes=tuple(_causes(held)),
        candidates=tuple(_candidate(r, found) for r in _best_forms(found.ranked)),
        not_testable=refused,
        rmse_simulation_rad_s=gain.rmse_simulation_rad_s,
        rmse_extended_rad_s=gain.rmse_extended_rad_s,
        noise_floor_rad_s=gain.noise_floor_rad_s,
        gain=gain.gain,
        gain_low=gain.low,
        gain_high=gain.high,
        remainder=None if silent else describe(views, found.spread),
        minimum_detectable=smallest_sizes(problem, testable, found.spread),
        views=views,
        traces=tuple(_traces(problem, fit)),
        extended=replace(model, effects=(*model.effects, *effects)),
        n_windows=problem.n_rows,
        warnings=(*warnings, *_warnings(held)),
    )


def _warnings(held: _Held) -> Iterator[str]:
    """Yield what the user ought to know beside the verdict."""
    found = held.found
    yield from unknown_moments(found.problem.stretches)
    yield from said_beside(found, held.verdict)
    if held.sporadic is not None:
        yield (
            f"no simulation foresees which windows {held.sporadic.named.name} strikes: "
            "they count in full, before and after"
        )
    else:
        yield from left_unnamed(found.problem, found.fit.effects, found.spread)
    yield from warm_warnings(found.problem.known.began_warm)
    wander = found.problem.known.wander
    if wander.knows_warming:
        yield from long_warming(found.problem.stretches, wander.n_constants)


def _causes(held: _Held) -> list[NamedCause]:
    """Describe the named causes, the strongest first."""
    found = held.found
    problem, fit, spread = found.problem, found.fit, found.spread
    ranges, alone = intervals(problem, fit, spread), held.sporadic is not None
    waves = wave_sizes(problem, fit, spread)
    causes = []
    for k, (ranking, applied) in enumerate(zip(found.named, fit.effects, strict=True)):
        share = held.gain.gain
        if len(found.named) > 1:
            rest = Fit(tuple(a for i, a in enumerate(fit.effects) if i != k), 0.0, 0.0)
            without = held_out_gain(problem, foretold_rad_s(problem, rest), alone=alone)
            share = max(share - without.gain, 0.0)
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
                waves[k],
            )
        )
    causes = strongest_first(causes)
    if held.sporadic is not None:
        most = max((ranking[0].statistic for ranking in found.named), default=0.0)
        strongest = held.sporadic.deviance > most * spread**2
        causes.insert(0 if strongest else len(causes), held.sporadic.named)
    return causes


def _estimates(applied: Applied, ranges: dict[str, tuple[float, float]]) -> tuple[Estimate, ...]:
    """Describe the parameters."""
    found = []
    for p in applied.effect.parameters:
        value = applied.values[p.name]
        low, high = ranges.get(p.name, (p.low, p.high))
        found.append(Estimate(p.name, value, min(low, value), max(high, value), p.unit, p.what))
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
        r.misfit,
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
