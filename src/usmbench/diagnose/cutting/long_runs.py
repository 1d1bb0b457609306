"""Runs that last longer than those that the naming of causes is measured on."""

from collections.abc import Sequence

from usmbench.diagnose.cutting.stretches import Stretch

# Runs of a minute, what precedes their plan included: those of benchmarks/naming_campaign.py.
_MEASURED_S = 70.0


def long_warming(stretches: Sequence[Stretch]) -> list[str]:
    """Say in which runs a motor may have warmed otherwise than its model knows.

    Parameters
    ----------
    stretches
        The runs.

    Returns
    -------
    list of str
        One warning a run.
    """
    begins_s: dict[str, float] = {}
    lasts_s: dict[str, float] = {}
    for s in stretches:
        begin_s = begins_s.setdefault(s.name, float(s.context.t_s[0]))
        lasts_s[s.name] = float(s.context.t_s[-1]) - begin_s
    return [
        f"{name}: over {last_s:.0f} s a motor warms by more than over the minute of the campaigns, "
        "and some healthy ones have got names, thermal_drift above all; see whether runs of a "
        "minute say the same, with a model identified on such runs"
        for name, last_s in lasts_s.items()
        if last_s > _MEASURED_S
    ]
