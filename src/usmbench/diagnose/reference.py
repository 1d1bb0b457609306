"""What the runs that a model was identified on teach about judging others."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from usmbench.diagnose.cutting.check_runs import FEWEST_WINDOWS
from usmbench.diagnose.cutting.command_times import any_moment_s, at_unknown_moments
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.healthy_runs import HealthyRuns
from usmbench.diagnose.known.knowledge import Knowledge
from usmbench.diagnose.known.left_out import covariance_root
from usmbench.diagnose.known.model_knowledge import with_known
from usmbench.diagnose.known.wander import wander_of_shares
from usmbench.diagnose.known.wander_estimate import measured_wander
from usmbench.diagnose.known.wander_shares import ANY, LEAST
from usmbench.diagnose.naming.ranking import rank
from usmbench.diagnose.residual.problem import Problem
from usmbench.errors import InputError
from usmbench.identify.wild_rows import without_wild_rows
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Stage
from usmbench.model.effects.registry import library
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.pauses import cold_starts
from usmbench.runs.record import Record

_FEWEST_ROUNDS, _MOST_ROUNDS = 3, 12
_SETTLED = 0.2  # of each deviation: what is learnt goes with what the runs wander by
_NO_CHANCE = 30.0  # a deviance that no chance explains


def with_knowledge(model: HammersteinModel, records: Sequence[Record]) -> HammersteinModel:
    """Return a model that carries what the runs it was identified on show.

    Parameters
    ----------
    model
        The identified model.
    records
        Those runs. Runs whose windows the model does not describe (a list of settled pairs, a
        handful of rows) leave the model as it is.
    """
    records = [
        without_wild_rows(part)
        for record in records
        for part in cold_starts(record, FEWEST_WINDOWS)
    ]
    try:
        stretches, _ = cut_runs(records, model, ())
    except InputError:
        return model
    habits = _built_in(stretches)
    if habits:
        stretches, _ = cut_runs(records, model, habits)
    known = measure_knowledge(stretches, habits)
    stages: tuple[Stage, ...] = ("command", "settled")
    for stage in stages:
        # The shapes that are known would hide what a curve cannot be, and need not share it.
        without = known if stage == "command" else known.nothing
        found = _habit(stretches, without, habits, stage)
        if found:
            habits += found
            stretches, _ = cut_runs(records, model, habits)
            known = measure_knowledge(stretches, habits)
    return with_known(model, known)


def _built_in(stretches: Sequence[Stretch]) -> tuple[Applied, ...]:
    """Return what the runs say that their bench does to every command."""
    contexts = [s.context for s in stretches]
    said: dict[str, Applied] = {}
    for effect in library():
        values = effect.built_in(contexts)
        if values is not None:
            said.setdefault(effect.name, Applied(effect, values))
    return tuple(said.values())


def _habit(
    stretches: Sequence[Stretch], known: Knowledge, own: Sequence[Applied], stage: Stage
) -> tuple[Applied, ...]:
    """Return what healthy runs plainly show at a stage, beyond what is known."""
    contexts = [s.context for s in stretches]
    names = {applied.effect.name for applied in own}
    effects = [
        e for e in library() if e.stage == stage and e.name not in names and e.habitual(contexts)
    ]
    if known.noise is None or not effects:
        return ()
    problem = Problem(stretches, known, known.noise, [s.use for s in stretches], own)
    best = rank(problem, effects, 1.0)[0]
    return best.fit.effects if best.statistic > _NO_CHANCE else ()


def measure_knowledge(stretches: Sequence[Stretch], habits: Sequence[Applied] = ()) -> Knowledge:
    """Measure noise, known misfit and repeatability.

    What the model leaves, what the runs wander by and the noise are learnt in turn until they rest.

    Parameters
    ----------
    stretches
        The runs that the model was identified on.
    habits
        What they show anyhow, with which they were cut.
    """
    any_s = any_moment_s(stretches)
    runs = HealthyRuns.of(at_unknown_moments(stretches, any_s), habits)
    features, left, masks = runs.features, runs.residuals, runs.uses
    widest, least = (wander_of_shares(shares, features) for shares in (ANY, LEAST))
    wander, noise = widest, runs.noise(left, masks)
    for done in range(_MOST_ROUNDS):
        masks = runs.near(left, noise)
        learnt, left = runs.learnt(noise, masks, wander)
        unit = wander.deviations
        gram = learnt.gram / unit[:, None, None] / unit
        wander = measured_wander(widest, least, gram, learnt.slope / unit)
        noise = runs.noise(left, masks)
        settled = np.allclose(wander.deviations, unit, rtol=_SETTLED, atol=0.0)
        if settled and done + 1 >= _FEWEST_ROUNDS:
            break
    spikes_hz = runs.spikes_hz(left, noise)
    wander = replace(wander, late_s=max(wander.late_s, any_s))
    entries = tuple(applied.to_mapping() for applied in habits)
    root = covariance_root(features, learnt)
    return Knowledge(noise, features, learnt.mean, root, wander, spikes_hz, entries)
