"""What the user ought to know beside a verdict: what was left aside, what no run has shown."""

from collections.abc import Iterator

import numpy as np

from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.naming.ranking import NO_CHANCE
from usmbench.diagnose.noise.noise_model import FARTHER
from usmbench.diagnose.result import Verdict

# Chosen while watching draws of simulated motors; no measurement fixes them.
_UNKNOWN, _MANY_ROWS = 0.1, 0.2  # of the highest speed; of the rows
_MANY_STEPS = 0.1  # of the steps: the two of a warm-up are one in forty of a phase sweep's
_FOREIGN = 0.2  # of the measured speed's rms


def said_beside(found: Found, verdict: Verdict) -> Iterator[str]:
    """Yield what to say beside a verdict, a sentence each.

    Parameters
    ----------
    found
        What the search came to.
    verdict
        The verdict.
    """
    yield from _unmeasured(found)
    yield from _unseen_steps(found)
    yield from _angles(found)
    if verdict == "no_discrepancy":
        yield from _left_aside(found)
    if verdict in ("partly_explained", "unexplained"):
        yield from _foreign(found)
    if verdict == "unexplained" and not found.plain:
        yield (
            "what is left could be the model's own error, larger than its runs let one expect; "
            "identify it on a healthy run of this plan, too, and diagnose again"
        )


def _unmeasured(found: Found) -> Iterator[str]:
    """Say where the model was hardly measured."""
    problem = found.problem
    uses = [s.use for s in problem.stretches]
    off_rad_s = np.concatenate(problem.unsure_rad_s(uses))[np.concatenate(uses)]
    share = float(np.mean(off_rad_s > _UNKNOWN * problem.known.features.top_rad_s))
    if share >= _MANY_ROWS:
        yield (
            f"on {100.0 * share:.0f} % of the rows the model may be off by {100.0 * _UNKNOWN:.0f} "
            "% of the highest speed and more, such as between phases that its runs did not drive: "
            "they tell little; identify it on a run that drives them"
        )


def _unseen_steps(found: Found) -> Iterator[str]:
    """Say where a run's steps are larger than any whose course the model was identified on.

    A motor follows a large step later than a small one: its torque has a limit.
    """
    problem = found.problem
    largest_rad_s = float(np.max(problem.noise.step_rad_s[0]))
    steps = np.concatenate([np.abs(s.step_rad_s[s.use & (s.lag == 0)]) for s in problem.stretches])
    if np.count_nonzero(steps > FARTHER * largest_rad_s) > _MANY_STEPS * steps.size:
        yield (
            f"steps of up to {steps.max():.3g} rad/s, where the model's runs tell of steps of up "
            f"to {largest_rad_s:.2g} rad/s: how the motor follows larger ones it does not know; "
            "identify it on a run with such steps as well"
        )


def _angles(found: Found) -> Iterator[str]:
    """Say which named causes have an angle that is that of the runs' counter."""
    for applied in found.fit.effects:
        if applied.effect.waves:
            yield (
                f"{applied.effect.name}: its angle is that of the counter in these runs; where a "
                "counter begins elsewhere, replay puts the ripple elsewhere, and only diagnose "
                "finds its place again"
            )


def _foreign(found: Found) -> Iterator[str]:
    """Say where so much is off, and not all explained, that the motor may not be the model's."""
    judged = list(zip(found.problem.stretches, found.problem.masks, strict=True))
    off = np.concatenate([s.residual_rad_s[mask] for s, mask in judged])
    speed = np.concatenate([s.speed_rad_s[mask] for s, mask in judged])
    share = float(np.linalg.norm(off)) / max(float(np.linalg.norm(speed)), 1e-12)
    if share > _FOREIGN:
        yield (
            f"the simulation is off by {100.0 * share:.0f} % of the measured speed (root mean "
            "square), and no name explains all of it: the runs may be of another motor, or of "
            "another operating point, than the model's"
        )


def _left_aside(found: Found) -> Iterator[str]:
    """Say what is beyond chance in one part of the runs only, where nothing is named."""
    best = found.ranked[0]
    if best.p_value < NO_CHANCE and best.effect.name not in found.problem.known.habit_names:
        yield (
            f"{best.effect.name} explains more than chance leaves, but not in parts of the runs "
            "that its fit has not seen, so it is no name; drive the plan again, or one that "
            "repeats its passes"
        )
