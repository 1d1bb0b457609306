"""What is left over, in a sentence."""

from collections.abc import Sequence

import numpy as np

from usmbench.diagnose.result import Remainder, View

_SAYS = {
    "phase": "the residual depends on the commanded phase, most around {at:.3g}°",
    "direction": "the residual depends on whether the phase rose or fell, most around {at:.3g}°",
    "time": "the residual changes over the run, most around {at:.3g} s",
    "lag": "the residual follows the steps of the phase, most {at:.3g} windows after",
    "angle": "the residual depends on the shaft's angle, most around {at:.3g} rad",
    "speed": "the residual depends on the speed, most around {at:.3g} rad/s",
}


def describe(views: Sequence[View]) -> Remainder | None:
    """Return the view that exceeds its band most after the extension.

    Parameters
    ----------
    views
        The views.
    """
    if not views:
        return None
    worst = max(views, key=lambda view: view.excess_after)
    k = int(np.argmax(np.abs(worst.after_rad_s) / worst.band_rad_s))
    says = _SAYS[worst.versus].format(at=float(worst.centre[k]))
    size = float(worst.after_rad_s[k])
    return Remainder(
        worst.versus,
        f"{says} ({size:+.3g} rad/s, {worst.excess_after:.2g} times what noise would leave)",
    )
