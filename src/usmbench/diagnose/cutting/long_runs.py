"""Runs that last longer than those that showed how their motor warms."""

from collections.abc import Sequence

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.cutting.warmth import n_constants


def lasts_s(stretches: Sequence[Stretch]) -> dict[str, float]:
    """Return for how long each run drives the motor, by its name.

    Parameters
    ----------
    stretches
        The runs.
    """
    begins_s: dict[str, float] = {}
    found: dict[str, float] = {}
    for s in stretches:
        first_s, last_s = s.context.driving.driven_s(s.context.t_s[[0, -1]]).tolist()
        found[s.name] = last_s - begins_s.setdefault(s.name, first_s)
    return found


def long_warming(stretches: Sequence[Stretch], n_known: int) -> list[str]:
    """Say in which runs a motor may have warmed further than its model knows.

    Parameters
    ----------
    stretches
        The runs.
    n_known
        How many thermal time constants the model knows.

    Returns
    -------
    list of str
        One warning a run.
    """
    return [
        f"{name}: driven for {last_s:.0f} s, longer than the runs of the model, so that it does "
        "not know how the motor warms in the end: what looks like that is no news; identify a "
        "model on runs as long"
        for name, last_s in lasts_s(stretches).items()
        if n_constants(last_s) > n_known
    ]
