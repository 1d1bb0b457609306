"""The verdict: whether names may stand, or whether there is something to be named.

Two steps that come later change it: `usmbench.diagnose.held.held`, for names that gain nothing on
unseen rows and for the scatter that chance leaves, and `usmbench.diagnose.described.described`,
for an explanation that leaves plainly more than the model's own runs show.
"""

from usmbench.diagnose.naming.chance import chancy_of, leaves_scatter
from usmbench.diagnose.naming.found import LEFT_PARTLY, Found
from usmbench.diagnose.naming.ranking import NO_CHANCE
from usmbench.diagnose.residual.whole import PLAIN_P_VALUE, Whole, excused
from usmbench.diagnose.result import Verdict

_MOST_NAMED = 2  # where a third earns its place, too, it is more likely that none is the cause
# The others were chosen as the thresholds of `usmbench.diagnose.naming.found` were.
# How far what is no news may depart is an estimate: of that only what is larger than the noise.
_LEAST_HIDDEN = 1.0
_MOSTLY = 0.5  # of what is off
_LEFT_EXPLAINED = 0.08  # of what was off: names that leave less explain it


def verdict_on(found: Found, struck: float) -> Verdict:
    """Say whether what is named may stand.

    Parameters
    ----------
    found
        What the search came to.
    struck
        Deviance of the windows that stand alone, where they have a cause; 0 for none.
    """
    if found.named:
        return _on_named(found)
    # Windows that stand alone are not the matter where most is wrong elsewhere.
    elsewhere = max(found.before.excess, _MOSTLY * found.off_in_all)
    if struck > elsewhere:
        return "explained" if found.before.p_value > PLAIN_P_VALUE else "partly_explained"
    return _on_nothing_named(found)


def _on_nothing_named(found: Found) -> Verdict:
    """Say whether there is something to be named."""
    hidden = excused(found.problem, found.spread)
    if found.plain or hidden.beyond(NO_CHANCE, _LEAST_HIDDEN):
        return "unexplained"
    return "no_discrepancy"


def _on_named(found: Found) -> Verdict:
    """Say whether names may stand, and whether they are all."""
    says = by_share_left(found.before, found.after, found.explained)
    if len(found.named) > _MOST_NAMED:
        return "unexplained"
    # Scatter is not smooth: what the views show of it is little.
    if chancy_of(found.fit.effects) and found.leaves_more:
        return _on_nothing_named(found)
    if found.patched or (says != "explained" and found.on_a_grid):
        return "unexplained"
    if found.at_an_end:
        return _on_nothing_named(found)
    # Several that leave something are patches on what the library does not know.
    if says == "unexplained" or found.mostly_left or (says != "explained" and found.named[1:]):
        if not leaves_scatter(found.problem, found.fit.effects):
            return "unexplained"
        return "partly_explained"
    return _on_nothing_named(found) if found.leaves_more else says


def by_share_left(before: Whole, after: Whole, statistic: float) -> Verdict:
    """Return what the share that named causes leave in the views says of them.

    Parameters
    ----------
    before, after
        The test over all views without and with the causes.
    statistic
        Drop of the deviance that they bring.
    """
    share = after.excess / max(before.excess, statistic, 1e-12)
    if after.p_value > PLAIN_P_VALUE or share < _LEFT_EXPLAINED:
        return "explained"
    return "unexplained" if share > LEFT_PARTLY and after.material else "partly_explained"
