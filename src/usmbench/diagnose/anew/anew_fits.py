"""Curve and dynamics fitted again with a cause in place, and judged on rows they have not seen."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.anew.through_counter import Estimated, fit_through
from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.fitting.blocks import FOLDS, held_out
from usmbench.identify.selection import DEGREES
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Effect
from usmbench.model.hammerstein import HammersteinModel, StaticCurve

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class CrossValidated:
    """A fit, those to three quarters of the blocks, and what they leave of the fourth.

    Parameters
    ----------
    fit
        To all rows.
    folds
        To all blocks but every fourth, one for each choice of these.
    unseen_rad_s
        What each leaves of those that it has not seen, by stretch, shape (N,).
    mean_square
        Mean square of that on the rows to judge, in (rad/s)².
    """

    fit: Estimated
    folds: tuple[Estimated, ...]
    unseen_rad_s: tuple[Array, ...]
    mean_square: float


def plain_fits(stretches: Sequence[Stretch], model: HammersteinModel) -> Iterator[Estimated]:
    """Yield fits without a cause, of the model's degree and of lower ones.

    What has no cause in place may choose among curves, too: one of too high a degree would lose
    to a cause for what it overfits.

    Parameters
    ----------
    stretches
        The runs.
    model
        The model.
    """
    curve = model.points[0].curve
    yield fit_curve(stretches, model, curve, None)
    for degree in (d for d in DEGREES if d < curve.degree):
        places = np.linspace(0.0, curve.degree, degree + 1)
        knots_deg = np.interp(places, np.arange(curve.degree + 1.0), curve.knots_deg)
        lower = StaticCurve(knots_deg, curve.speed_rad_s(knots_deg))
        yield fit_curve(stretches, model, lower, None)


def fits_beneath(
    stretches: Sequence[Stretch], model: HammersteinModel, effect: Effect
) -> Iterator[Estimated]:
    """Yield a fit with a straight curve and one with the model's, folded at 0.

    Parameters
    ----------
    stretches
        The runs.
    model
        The model that may have been misled.
    effect
        The cause to put in place.
    """
    curve, top = model.points[0].curve, max(float(np.max(s.speed_rad_s)) for s in stretches)
    ends_deg = curve.knots_deg[[0, -1]]
    straight = StaticCurve(ends_deg, top * ends_deg / float(np.max(np.abs(ends_deg))))
    folded = StaticCurve(curve.knots_deg, np.sign(curve.knots_deg) * np.abs(curve.delta))
    applied = Applied(effect, {p.name: p.null + p.typical for p in effect.parameters})
    for shape in (straight, folded):
        yield fit_curve(stretches, model, shape, applied)


def fit_curve(
    stretches: Sequence[Stretch],
    model: HammersteinModel,
    curve: StaticCurve,
    applied: Applied | None,
) -> Estimated:
    """Fit from a curve; where the counter misled, it may have feigned the dead time.

    Parameters
    ----------
    stretches
        The runs.
    model
        The model whose dynamics to begin from.
    curve
        The curve.
    applied
        The cause in place; None for none.
    """
    found = []
    for dead in {0, model.linear.dead_time_windows}:
        linear = replace(model.linear, dead_time_windows=dead, slip_limit_rad_s=None)
        start = Estimated(linear, curve, applied, np.zeros(len(stretches)), ())
        found.append(fit_through(stretches, _rows(stretches, curve), start))
    return min(found, key=lambda fit: fit.mean_square)


def cross_validate(stretches: Sequence[Stretch], fit: Estimated) -> CrossValidated:
    """Fit all blocks but every fourth, and see what that leaves of these.

    Parameters
    ----------
    stretches
        The runs.
    fit
        To all rows.
    """
    unseen, folds = [left.copy() for left in fit.left_rad_s], []
    every = _rows(stretches, fit.curve)
    for k in range(FOLDS):
        held = [held_out(s, k) for s in stretches]
        # No gap around them: the blocks of a short run of slow dynamics are hardly longer than one.
        seen = [rows & ~left_out for rows, left_out in zip(every, held, strict=True)]
        folds.append(fit_through(stretches, seen, fit))
        for own, left, rows in zip(unseen, folds[-1].left_rad_s, held, strict=True):
            own[rows] = left[rows]
    left = np.concatenate([own[s.use] for s, own in zip(stretches, unseen, strict=True)])
    return CrossValidated(fit, tuple(folds), tuple(unseen), float(np.mean(left**2)))


def _rows(stretches: Sequence[Stretch], curve: StaticCurve) -> list[Mask]:
    """Rows within the range of the curve."""
    low_deg, high_deg = curve.knots_deg[[0, -1]]
    phases_deg = [s.context.phase_deg for s in stretches]
    return [(phase_deg >= low_deg) & (phase_deg <= high_deg) for phase_deg in phases_deg]
