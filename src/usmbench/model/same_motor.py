"""Whether runs say that they are of the motor and the encoder that a model's runs were of."""

from collections.abc import Sequence
from typing import Any

from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record


def another_motor(records: Sequence[Record], model: HammersteinModel) -> list[str]:
    """Warn of runs of another motor or encoder than the model's, one line each.

    The model of a simulated bench may be meant for the real one: it is for the user to say.

    Parameters
    ----------
    records
        The runs, which `usmbench.runs.check_record.check_together` takes for those of one motor.
        What they, or the model's, do not say may be anything.
    model
        The model.
    """
    warnings = []
    for key in ("motor", "counts_per_rev"):
        known = {run[key] for run in model.fitted_on if run.get(key) is not None}
        others = {r.name: said for r in records if (said := getattr(r, key)) not in {None, *known}}
        if known and others:
            first, *more = others
            names = f"{first} and {len(more)} more" if more else first
            there = " or ".join(sorted(map(_shown, known)))
            warnings.append(
                f"{names}: {key} is {_shown(others[first])} here and {there} in the runs of "
                f"{model.name}; what is found may be no more than that: take a model of its own, "
                "or mend run.yaml where it is wrong"
            )
    return warnings


def _shown(said: Any) -> str:
    return said if isinstance(said, str) else f"{said:.12g}"
