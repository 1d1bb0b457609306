"""What is said of the next experiment, by the page and on the terminal."""

from collections.abc import Mapping
from typing import Any

from usmbench.diagnose.result import Diagnosis
from usmbench.report.numbers_text import probability_of


def why_no_experiment(diagnosis: Diagnosis) -> str:
    """Return why no experiment is proposed.

    Parameters
    ----------
    diagnosis
        A diagnosis that proposes none.
    """
    if not any(cause.alternatives for cause in diagnosis.causes):
        return "none is proposed: no causes are left that a sweep would tell apart"
    if all(point.frequency_hz is None for point in diagnosis.extended.points):
        return (
            "none is proposed: the model does not say at which drive frequency it holds, which a "
            "plan needs; give its runs a column frequency_hz, identify it on them, diagnose again "
            "(docs/how-to/bring-your-data.md)"
        )
    return (
        "none is proposed: no plan within what this model knows (its phases, drive frequencies and "
        "loads) would tell these causes apart; identify it at a second drive frequency, or with a "
        "load, and diagnose again (docs/how-to/decide-between-causes.md)"
    )


def odds_of(proposal: Mapping[str, Any]) -> tuple[str, str] | None:
    """Return the odds of telling the causes apart, without and with an experiment.

    Parameters
    ----------
    proposal
        The next experiment of a diagnosis.

    Returns
    -------
    tuple of str and str, or None
        None where the proposal says nothing of odds.
    """
    if "odds_before" not in proposal:
        return None
    return probability_of(proposal["odds_before"]), probability_of(proposal["odds_after"])
