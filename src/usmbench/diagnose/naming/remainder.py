"""What is left over, in a sentence."""

from collections.abc import Sequence

import numpy as np

from usmbench.diagnose.result import Remainder, View

_SAYS = {
    "phase": "the residual depends on the commanded phase, most around {at:.3g}°",
    "direction": "the residual depends on whether the phase rose or fell, most around {at:.3g}°",
    "time": "the residual changes over the run, most around {at:.3g} s",
    "gain over time": "the residual along the motion changes over the run, most around {at:.3g} s",
    "lag": "the residual follows the steps of the phase, most {at:.3g} windows after",
    "angle": "the residual depends on the shaft's angle, most around {at:.3g} rad",
    "speed": "the residual depends on the speed, most around {at:.3g} rad/s",
}
_VERSUS = {"gain over time": "time"}  # views of one thing
LOUD = 1.5  # times the noise of the model's runs, from which on it is a finding by itself


def describe(views: Sequence[View], spread: float) -> Remainder:
    """Return the view that exceeds its band most after the extension.

    Parameters
    ----------
    views
        The views.
    spread
        Standard deviation of the noise that no view shows, over that of the model's runs.
    """
    worst = max(views, key=lambda view: view.excess_after)
    if spread > LOUD and worst.excess_after < LOUD:
        return Remainder(
            "noise",
            f"the windows scatter {spread:.2g} times as widely as in the model's runs, without a "
            "pattern: look for what is faster than a window, such as a ripple of the supply",
        )
    k = int(np.argmax(np.abs(worst.after_rad_s) / worst.band_rad_s))
    says = _SAYS[worst.versus].format(at=float(worst.centre[k]))
    size = float(worst.after_rad_s[k])
    if worst.excess_after < 1.0:
        says = f"no view by itself shows more than noise leaves; most: {says}"
    return Remainder(
        _VERSUS.get(worst.versus, worst.versus),
        f"{says} ({size:+.3g} rad/s, {worst.excess_after:.2g} times what noise would leave)",
    )
