"""What was found, as far as it stands."""

from dataclasses import dataclass

from usmbench.diagnose.fitting.foretold import foretells_nothing, foretold_rad_s
from usmbench.diagnose.fitting.gain import Gain, held_out_gain, left_over
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.naming.ranking import NO_CHANCE
from usmbench.diagnose.naming.sporadic import Sporadic, find_sporadic
from usmbench.diagnose.naming.verdict import verdict_on
from usmbench.diagnose.residual.whole import PLAIN_P_VALUE
from usmbench.diagnose.result import STANDS, Verdict


@dataclass(frozen=True, slots=True)
class Held:
    """What was found, as far as it stands and predicts rows that its fit has not seen.

    Parameters
    ----------
    found
        What the search came to, without names that do not stand.
    verdict
        What is said of it.
    sporadic
        The cause of windows that stand alone; None for none.
    gain
        What the names gain on rows that their values were not fitted on.
    left_over
        The rms of what they leave there, over that which the model's own runs show.
    """

    found: Found
    verdict: Verdict
    sporadic: Sporadic | None
    gain: Gain
    left_over: float


def held(found: Found, given: Sporadic | None = None) -> Held:
    """Judge what was found, and once more without the names where they gain nothing.

    Parameters
    ----------
    found
        What the search came to.
    given
        The cause of windows that stand alone, where these were left out; None to look for one.
    """
    sporadic = given or find_sporadic(found.problem, found.fit.effects, found.spread)
    if sporadic is not None and sporadic.named.name in found.names:
        sporadic = None
    scattered = found.count_scatter()
    says = verdict_on(found, sporadic)
    if says not in STANDS and scattered is not found:
        # The search keeps what is far out from its fits: of what chance does, they leave a part.
        says = verdict_on(scattered, sporadic)
    if says not in STANDS:
        unnamed = found.drop_names()
        if found.named:
            # That names do not stand says nothing against windows that stand alone, which lost
            # counts among them take for their own.
            without = held(unnamed, given)
            if without.sporadic is not None:
                return without
        found = scattered = unnamed
        sporadic = None
    if scattered is not found and scattered.after.p_value > PLAIN_P_VALUE:
        says = "explained"
    foretold = foretold_rad_s(scattered.problem, scattered.fit)
    # Two causes and a rare day, which hides them: there is another explanation.
    sure = len(found.named) == 1 and found.named[0][0].p_value < NO_CHANCE
    if found.named and foretells_nothing(scattered.problem, foretold, sure=sure):
        return held(found.drop_names(), given)
    problem, alone = scattered.problem, sporadic is not None
    gain = held_out_gain(problem, foretold, alone=alone)
    return Held(scattered, says, sporadic, gain, left_over(problem, foretold, alone=alone))
