"""Runs cut beside the effects that their model has already, and these in doubt."""

from collections.abc import Sequence
from dataclasses import replace

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.one_angle import at_models_angle, at_one_angle
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.knowledge import Knowledge
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.residual.form import doubting_own
from usmbench.model.applied import Applied, applied_effects, foreseen_effects
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record


def own_effects(model: HammersteinModel) -> tuple[Applied, ...]:
    """Return a model's effects, and what healthy runs are known to show.

    Parameters
    ----------
    model
        The model. What strikes single windows is left out: no simulation foresees which.
    """
    return (*foreseen_effects(model.effects), *applied_effects(knowledge_of(model).habits))


def known_of(model: HammersteinModel) -> Knowledge:
    """Return what is known of a model, its effects that strike single windows among it.

    Parameters
    ----------
    model
        The model.
    """
    sporadic = tuple(a for a in applied_effects(model.effects) if a.effect.sporadic)
    return replace(knowledge_of(model), sporadic=sporadic)


def cut_beside_own(
    records: Sequence[Record], model: HammersteinModel, *, doubted: bool = True
) -> tuple[list[Stretch], list[str]]:
    """Cut runs, and shift the angles of those of one disc.

    Parameters
    ----------
    records
        The runs.
    model
        The model.
    doubted
        Whether the form of the effects by which the model was extended may be off.

    Returns
    -------
    stretches, warnings
        In the order of runs and time, and what the user ought to know.

    Raises
    ------
    usmbench.errors.InputError
        Runs that do not belong to the model or together, or too short to say anything.
    """
    own = own_effects(model)
    stretches, warnings = cut_runs(records, model, own)
    in_doubt = own[: len(foreseen_effects(model.effects))] if doubted else ()
    stretches, told = at_models_angle(stretches, own) if in_doubt else at_one_angle(stretches)
    return doubting_own(stretches, own, in_doubt), [*warnings, *told]
