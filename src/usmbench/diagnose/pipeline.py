"""From runs and a model to a diagnosis."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from usmbench.diagnose.anew.identify_anew import identified_anew
from usmbench.diagnose.cutting.check_runs import FEWEST_WINDOWS, check_driven, check_moves
from usmbench.diagnose.cutting.command_times import any_moment_s, at_unknown_moments
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.described import described
from usmbench.diagnose.held import held
from usmbench.diagnose.known.guessed_steps import following_guesses
from usmbench.diagnose.naming.as_simulated import as_simulated
from usmbench.diagnose.naming.began_warm import WarmStart
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.naming.search import search
from usmbench.diagnose.naming.verdict import verdict_on
from usmbench.diagnose.residual.own_effects import cut_beside_own, known_of, own_effects
from usmbench.diagnose.residual.own_gone import gone_effects
from usmbench.diagnose.result import Diagnosis
from usmbench.model.applied import foreseen_effects
from usmbench.model.effects.registry import library
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.pauses import cold_starts
from usmbench.runs.record import Record


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
        Runs that do not belong to the model or together, that were not driven, whose speed does not
        change, or that are too short to say anything.
    """
    for record in records:
        check_driven(record)
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
    known, own = known_of(model), own_effects(model)
    mended = own[: len(foreseen_effects(model.effects))]
    effects += gone_effects(mended)
    late_s = max(known.wander.late_s, any_moment_s(stretches))
    known = replace(known, wander=replace(known.wander, late_s=late_s))
    marked = at_unknown_moments(stretches, late_s)
    marked = following_guesses(marked, known.features, known.mean)
    found = search(marked, known, own, effects)
    says = verdict_on(found, 0.0)
    if says == "no_discrepancy":
        return found
    quiet = as_simulated(found)
    if quiet is not None:
        return quiet
    start = WarmStart.of(found)
    names = start.names
    if not names:
        return found
    warm = search(marked, replace(known, began_warm=names), own, effects)
    if not start.tells_more(warm):
        return found
    if_cold = () if says == "unexplained" else found.names
    return replace(warm, if_cold=tuple(name for name in if_cold if name not in warm.names))


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
    stands = held(searched(stretches, model))
    while stands.leaves_out:
        struck = list(zip(stretches, stands.sporadic[-1].touched, strict=True))
        if not any(np.any(s.use & rows) for s, rows in struck):
            break
        stretches = [replace(s, use=s.use & ~rows) for s, rows in struck]
        stands = held(searched(stretches, model), stands.sporadic)
    return described(stands, model, testable, tuple(refused.items()), warnings)
