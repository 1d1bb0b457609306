"""What the runs that a model was identified on teach about judging others."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from usmbench.diagnose.knowledge import KEY, measure_knowledge
from usmbench.diagnose.search import search
from usmbench.diagnose.stretches import cut_runs
from usmbench.errors import InputError
from usmbench.model.effects.registry import library
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record


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
    try:
        stretches, _ = cut_runs(records, model, ())
    except InputError:
        return model
    known = measure_knowledge(model, stretches)
    contexts = [s.context for s in stretches]
    effects = [e for e in library() if not e.sporadic and e.untestable(contexts) is None]
    found = search(stretches, known, (), effects)
    n = sum(int(np.count_nonzero(s.use)) for s in stretches)
    known = replace(
        known,
        habits=tuple(applied.to_mapping() for applied in found.fit.effects),
        spikes_hz=found.n_spikes / (n * stretches[0].context.window_s),
    )
    return replace(model, residual={**model.residual, KEY: known.to_mapping()})
