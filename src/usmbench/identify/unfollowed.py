"""Samples that a fit leaves out though they hang together: a curve that turns elsewhere."""

import numpy as np
from scipy.ndimage import median_filter

from usmbench.identify.data import Dataset, describe
from usmbench.identify.robust_fit import RobustFit

_FAR_SCALES, _FAR_SHARE = 10.0, 0.03  # of the residual's scale, of the highest speed
_LIKE, _FEWEST = 9, 5  # samples: those at the nearest phases, and enough to speak of
_AS_FAR = 0.5  # of what a sample is off by: their median is no chance


def unfollowed(data: Dataset, search: RobustFit) -> list[str]:
    """Warn of samples that count as outliers where those at like phases are off as well.

    A few phases beyond a bend that the curve has missed look like outliers, and keep it from
    turning there.

    Parameters
    ----------
    data
        The samples of the search.
    search
        Its end.

    Returns
    -------
    list of str
        A warning for each operating point that has such samples.
    """
    warnings, problem = [], search.problem
    for point, operating_point in enumerate(data.points):
        own = [k for k, s in enumerate(problem.stretches) if s.point == point]
        phase_deg = np.concatenate([problem.stretches[k].phase_deg for k in own])
        off_rad_s = np.concatenate([problem.fit.residual_rad_s[k] for k in own])
        by_phase = np.argsort(phase_deg, kind="stable")
        phase_deg, off_rad_s = phase_deg[by_phase], off_rad_s[by_phase]
        scale_rad_s = max(search.settled_rad_s, search.changing_rad_s)
        top_rad_s = float(np.max(np.abs(problem.fit.delta[point])))
        like_rad_s = median_filter(off_rad_s, _LIKE)
        together = np.sign(off_rad_s) * like_rad_s > _AS_FAR * np.abs(off_rad_s)
        left_out = together & (
            np.abs(off_rad_s) > max(_FAR_SCALES * scale_rad_s, _FAR_SHARE * top_rad_s)
        )
        n = int(np.count_nonzero(left_out))
        if n >= _FEWEST:
            far_rad_s = np.where(left_out, np.abs(off_rad_s), 0.0)
            most = int(np.argmax(far_rad_s))
            warnings.append(
                f"{data.name}: the curve{describe(operating_point)} passes {n} samples by up to "
                f"{far_rad_s[most]:.2g} rad/s, most at {phase_deg[most]:.1f}°, as if they were "
                "outliers; drive more phases there, or give it knots (--knots) or another degree "
                "(--degree)"
            )
    return warnings
