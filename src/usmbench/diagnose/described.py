"""What stands, as a diagnosis tells it: causes, candidates, gain, remainder, traces."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from usmbench.diagnose.cutting.command_times import unknown_moments
from usmbench.diagnose.cutting.long_runs import long_warming
from usmbench.diagnose.described_alone import lone_views, named_alone, said_alone
from usmbench.diagnose.evidence import Candidate, Estimate, NamedCause, strongest_first
from usmbench.diagnose.extended_effects import extended_effects
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.foretold import GROSS, foretold_rad_s
from usmbench.diagnose.fitting.gain import held_out_gain
from usmbench.diagnose.fitting.intervals import intervals
from usmbench.diagnose.fitting.wave_sizes import wave_sizes
from usmbench.diagnose.held import Held, counted_alone
from usmbench.diagnose.naming.began_warm import warm_warnings
from usmbench.diagnose.naming.beside_verdict import said_beside
from usmbench.diagnose.naming.chance import chancy_of
from usmbench.diagnose.naming.confined import confined
from usmbench.diagnose.naming.detectable import smallest_sizes
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.naming.left_wave import left_wave_hz
from usmbench.diagnose.naming.ranking import Ranked, alternatives, best_forms
from usmbench.diagnose.naming.remainder import LOUD, Beyond, describe
from usmbench.diagnose.naming.run_to_run import sizes_by_run
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.views import residual_views
from usmbench.diagnose.result import Diagnosis, Remainder, Trace, Verdict, View
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Effect
from usmbench.model.hammerstein import HammersteinModel

_MOST_POINTS = 3000
_SILENT = ("no_discrepancy", "explained")  # on what is left


def described(
    held: Held,
    model: HammersteinModel,
    testable: Sequence[Effect],
    refused: tuple[tuple[str, str], ...],
    warnings: Sequence[str],
) -> Diagnosis:
    """Put everything together.

    Parameters
    ----------
    held
        What stands.
    model
        The model.
    testable
        Effects that the runs can show.
    refused
        Names of causes that they cannot show, and why.
    warnings
        What was said of the runs when they were cut.
    """
    found, gain = held.found, held.gain
    problem, fit = found.problem, found.fit
    views = residual_views(problem, found.left_rad_s, found.spread)
    loud = held.left_over > LOUD and (_shown(views) or _scatters(found))
    if held.verdict == "explained" and loud:
        held = replace(held, verdict="partly_explained")
    silent = held.verdict in _SILENT
    return Diagnosis(
        verdict=held.verdict,
        causes=tuple(_causes(held)),
        candidates=tuple(_candidate(r, found) for r in best_forms(found.ranked)),
        not_testable=refused,
        rmse_simulation_rad_s=gain.rmse_simulation_rad_s,
        rmse_extended_rad_s=gain.rmse_extended_rad_s,
        noise_floor_rad_s=gain.noise_floor_rad_s,
        gain=gain.gain,
        gain_low=gain.low,
        gain_high=gain.high,
        remainder=None if silent else _remainder(found, views),
        minimum_detectable=smallest_sizes(problem, testable, found.spread, found.ranked),
        views=views,
        lone_views=lone_views(held),
        traces=tuple(_traces(problem, fit)),
        extended=replace(model, effects=extended_effects(held, model)),
        n_windows=problem.n_rows,
        warnings=(*warnings, *_one_run(model, held.verdict), *_warnings(held)),
        left_over=held.left_over,
    )


def _remainder(found: Found, views: Sequence[View]) -> Remainder:
    """Say what is left, whichever test it was that told."""
    # A gain that changes has a view of its own; what a day's gain may do hides when it did.
    if max(views, key=lambda view: view.excess_after).versus != "gain over time":
        only = confined(found.problem, found.fit.effects) or confined(found.problem, ())
        if only is not None:
            return only
    beyond = Beyond.of(found.problem, found.fit.effects, found.spread, found.after)
    wave_hz = left_wave_hz(found.problem.stretches, found.left_rad_s)
    return describe(views, found.spread, beyond, wave_hz)


def _shown(views: Sequence[View]) -> bool:
    """Whether a view shows plainly more than the noise leaves."""
    return max(view.excess_after for view in views) > LOUD


def _scatters(found: Found) -> bool:
    """Whether windows scatter plainly more than in the model's runs, by no chance that is named."""
    return found.spread > LOUD and not chancy_of(found.fit.effects)


def _one_run(model: HammersteinModel, verdict: Verdict) -> Iterator[str]:
    """Say that one run shows no repeatability, where something is off."""
    if len(model.fitted_on) == 1 and verdict != "no_discrepancy":
        yield (
            f"{model.name} was identified on one run, which cannot show by how much the motor "
            "differs from one run to the next: what is off may be no more than that; identify it "
            "on two runs or more"
        )


def _warnings(held: Held) -> Iterator[str]:
    """Yield what the user ought to know beside the verdict."""
    found = held.found
    yield from unknown_moments(found.problem.stretches)
    yield from said_beside(found, held.verdict)
    yield from sizes_by_run(found.problem, found.fit, found.spread)
    yield from _hidden(held)
    yield from _no_news(held)
    yield from said_alone(held)
    yield from warm_warnings(found.problem.known.began_warm, found.if_cold)
    wander = found.problem.known.wander
    if wander.knows_warming:
        yield from long_warming(found.problem.stretches, wander.n_constants)


def _hidden(held: Held) -> Iterator[str]:
    """Say where a name stands though it makes the simulation of these runs plainly worse."""
    before, after = held.gain.rmse_simulation_rad_s, held.gain.rmse_extended_rad_s
    if held.found.named and after**2 > GROSS * before**2:
        yield (
            "another day's motor, as far off as its model's runs have shown, hides "
            f"{held.found.names[0]} here: the extended model is farther from these runs "
            "than the one given, and its gain shows on another day"
        )


def _no_news(held: Held) -> Iterator[str]:
    """Say where a verdict leaves plainly more than the noise: what the model may be off by."""
    left, noise = held.gain.rmse_extended_rad_s, held.gain.noise_floor_rad_s
    every = (*held.found.problem.own, *held.found.fit.effects)
    by_chance = counted_alone(held.sporadic) or chancy_of(every)
    if held.verdict in _SILENT and not by_chance and left > LOUD * noise:
        yield (
            f"{left:.3g} rad/s are left where the noise is {noise:.2g}: no more than the model may "
            "be off by, as its own runs show, such as on a day of another gain or dead zone"
        )


def _causes(held: Held) -> list[NamedCause]:
    """Describe the named causes, the strongest first."""
    found = held.found
    problem, fit, spread = found.problem, found.fit, found.spread
    ranges, alone = intervals(problem, fit, spread), counted_alone(held.sporadic)
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
                by_chance=effect.by_chance,
            )
        )
    causes = strongest_first(causes)
    most = max((ranking[0].statistic for ranking in found.named), default=0.0)
    strongest = sum(cause.deviance for cause in held.sporadic) > most * spread**2
    singles = named_alone(held)
    return [*singles, *causes] if strongest else [*causes, *singles]


def _estimates(applied: Applied, ranges: dict[str, tuple[float, float]]) -> tuple[Estimate, ...]:
    """Describe the parameters."""
    found = []
    for p in applied.effect.parameters:
        value = applied.values[p.name]
        low, high = ranges.get(p.name, (p.low, p.high))
        found.append(Estimate(p.name, value, min(low, value), max(high, value), p.unit, p.what))
    return tuple(found)


def _candidate(r: Ranked, found: Found) -> Candidate:
    """Describe a cause of the library."""
    explained = r.statistic / max(found.before.excess, r.statistic, 1e-12)
    return Candidate(
        r.effect.name,
        r.effect.form,
        r.effect.meaning,
        r.statistic,
        len(r.effect.parameters),
        r.p_value,
        explained,
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
                stretch.speed_rad_s[rows],
                stretch.simulated_rad_s[rows],
                (stretch.simulated_rad_s + change)[rows],
            )
        )
    return traces
