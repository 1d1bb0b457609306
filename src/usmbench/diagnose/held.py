"""What was found, as far as it stands."""

from collections.abc import Sequence
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
        The causes of windows that stand alone, in the order in which they were found.
    gain
        What the names gain on rows that their values were not fitted on.
    left_over
        The rms of what they leave there, over that which the model's own runs show.
    leaves_out
        Whether windows that the last of `sporadic` strikes are to be left out yet.
    """

    found: Found
    verdict: Verdict
    sporadic: tuple[Sporadic, ...]
    gain: Gain
    left_over: float
    leaves_out: bool


def counted_alone(sporadic: Sequence[Sporadic]) -> bool:
    """Return whether windows that stand alone count in the gain: those of a cause do.

    Parameters
    ----------
    sporadic
        The causes of windows that stand alone. What one of them strikes may be left out.
    """
    return any(not cause.applied.effect.left_out for cause in sporadic)


def held(found: Found, left_out: tuple[Sporadic, ...] = ()) -> Held:
    """Judge what was found, and once more without the names where they gain nothing.

    Parameters
    ----------
    found
        What the search came to.
    left_out
        Causes of windows that stand alone, and were left out.
    """
    further = find_sporadic(found.problem, found.fit.effects, found.spread, left_out)
    if further is not None and further.named.name in found.names:
        further = None
    sporadic = (*left_out, further) if further is not None else left_out
    # What is known is left out whatever is said.
    known = left_out if further is None or further.is_news else sporadic
    struck = sum(cause.deviance for cause in sporadic)
    scattered = found.count_scatter()
    says = verdict_on(found, struck)
    if says not in STANDS and scattered is not found:
        # The search keeps what is far out from its fits: of what chance does, they leave a part.
        says = verdict_on(scattered, struck)
    if says not in STANDS:
        unnamed = found.drop_names()
        if found.named:
            # That names do not stand says nothing against windows that stand alone, which lost
            # counts among them take for their own.
            without = held(unnamed, left_out)
            if without.verdict in STANDS and any(cause.is_news for cause in without.sporadic):
                return without
        found = scattered = unnamed
        sporadic = known
    if scattered is not found and scattered.after.p_value > PLAIN_P_VALUE:
        says = "explained"
    foretold = foretold_rad_s(scattered.problem, scattered.fit)
    # Two causes and a rare day, which hides them: there is another explanation.
    sure = len(found.named) == 1 and found.named[0][0].p_value < NO_CHANCE
    if found.named and foretells_nothing(scattered.problem, foretold, sure=sure):
        return held(found.drop_names(), left_out)
    problem, alone = scattered.problem, counted_alone(sporadic)
    gain = held_out_gain(problem, foretold, alone=alone)
    leaves_out = any(cause.applied.effect.left_out for cause in sporadic[len(left_out) :])
    over = left_over(problem, foretold, alone=alone)
    return Held(scattered, says, sporadic, gain, over, leaves_out)
