"""What a search finds in a run, and which rows it judged."""

import numpy as np
from numpy.typing import NDArray

from known_motor import applied
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.pipeline import searched
from usmbench.diagnose.residual.own_effects import cut_beside_own
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record

DELAY = applied("transport_delay", "", delay_s=0.003)


def searched_run(record: Record, model: HammersteinModel) -> Found:
    return searched(cut_beside_own([record], model)[0], model)


def names_of(found: Found) -> set[str]:
    return set(found.names)


def judged_rows(found: Found, rows: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return which of some rows of the run are judged, those aside that none ever is."""
    ((stretch,), (mask,)) = found.problem.stretches, found.problem.masks
    judged: NDArray[np.bool_] = mask[rows[stretch.use[rows]]]
    return judged
