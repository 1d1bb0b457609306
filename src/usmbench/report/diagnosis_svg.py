"""Axes, lines, bands and markers as SVG text; colours and dashes are the page's style sheet's."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from usmbench.report.diagnosis_text import escaped

Array = NDArray[np.float64]

_TICK_PX = 4.0
_ROOM = 0.04  # share of the range left free above and below the data
_MARK_PX = 3.2


@dataclass(frozen=True, slots=True)
class Axis:
    """A range of a quantity laid over a stretch of the drawing.

    Parameters
    ----------
    low, high
        The range, low below high.
    start_px, end_px
        Where the ends lie, in the drawing's units.
    """

    low: float
    high: float
    start_px: float
    end_px: float

    def px(self, values: Array) -> Array:
        """Return where values lie, in the drawing's units.

        Parameters
        ----------
        values
            Values of the quantity, any shape.
        """
        share = (values - self.low) / (self.high - self.low)
        return np.asarray(self.start_px + share * (self.end_px - self.start_px))

    def ticks(self, spacing_px: float) -> list[tuple[float, str]]:
        """Return round values within the range, each with its label.

        Parameters
        ----------
        spacing_px
            Least distance of two ticks, in the drawing's units.
        """
        least = (self.high - self.low) * spacing_px / abs(self.end_px - self.start_px)
        decade = 10.0 ** math.floor(math.log10(least))
        step = next(m * decade for m in (1.0, 2.0, 5.0, 10.0) if m * decade >= least * (1 - 1e-9))
        digits = max(0, -math.floor(math.log10(step) + 1e-9))
        first, last = math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9)
        # Adding 0.0 turns a minus zero into a plain one.
        values = [k * step + 0.0 for k in range(first, last + 1)]
        return [(v, f"{v:.{digits}f}".replace("-", "−")) for v in values]


def data_range(*series: Array) -> tuple[float, float]:
    """Return a range that holds all series with some room, and is never empty.

    Parameters
    ----------
    *series
        Values, any shape; what is not finite does not count.
    """
    values = np.concatenate([np.ravel(s) for s in series])
    values = values[np.isfinite(values)]
    if values.size == 0:
        return -1.0, 1.0
    low, high = float(values.min()), float(values.max())
    room = _ROOM * (high - low) or 0.5 * abs(high) or 1.0
    return low - room, high + room


@dataclass(frozen=True, slots=True)
class Panel:
    """A pair of axes with a frame.

    Parameters
    ----------
    x, y
        The axes; y runs upwards.
    x_label, y_label
        Quantity and unit of each; an empty x label leaves the ticks without numbers.
    """

    x: Axis
    y: Axis
    x_label: str
    y_label: str

    def frame(self) -> str:
        """Return frame, grid, ticks and labels."""
        left, right, bottom, top = self.x.start_px, self.x.end_px, self.y.start_px, self.y.end_px
        parts = [_path(f"M{left:.1f} {top:.1f}H{right:.1f}V{bottom:.1f}H{left:.1f}Z", "frame")]
        for value, label in self.y.ticks(26.0):
            at = float(self.y.px(np.array(value)))
            parts.append(_path(f"M{left:.1f} {at:.1f}H{right:.1f}", "grid"))
            parts.append(_text(left - 5.0, at + 3.5, label, "tick end"))
        for value, label in self.x.ticks(48.0):
            at = float(self.x.px(np.array(value)))
            parts.append(_path(f"M{at:.1f} {bottom:.1f}v{_TICK_PX}", "frame"))
            if self.x_label:
                parts.append(_text(at, bottom + 16.0, label, "tick"))
        if self.x_label:
            parts.append(_text(0.5 * (left + right), bottom + 32.0, self.x_label, "axis"))
        at = 0.5 * (top + bottom)
        parts.append(_text(12.0, at, self.y_label, "axis", f"rotate(-90 12 {at:.1f})"))
        return "".join(parts)

    def line(self, x: Array, y: Array, style: str) -> str:
        """Return a line through the points; it breaks where a point is not finite.

        Parameters
        ----------
        x, y
            Points, shape (K,).
        style
            Class in the style sheet.
        """
        whole = np.isfinite(x) & np.isfinite(y)
        cuts = np.flatnonzero(np.diff(whole.astype(np.int8))) + 1
        pieces = [p for p in np.split(np.arange(x.size), cuts) if p.size and whole[p[0]]]
        return _path("".join("M" + self._points(x[p], y[p]) for p in pieces), style)

    def band(self, x: Array, low: Array, high: Array, style: str) -> str:
        """Return the area between two lines.

        Parameters
        ----------
        x, low, high
            Both lines' points, shape (K,); those that are not finite are left out.
        style
            Class in the style sheet.
        """
        keep = np.isfinite(x) & np.isfinite(low) & np.isfinite(high)
        if not np.any(keep):
            return ""
        there, back = x[keep], x[keep][::-1]
        round_trip = self._points(np.r_[there, back], np.r_[high[keep], low[keep][::-1]])
        return _path(f"M{round_trip}Z", style)

    def marks(self, x: Array, y: Array, shape: Literal["circle", "square"], style: str) -> str:
        """Return a mark at each point; the shapes can be told apart without colour.

        Parameters
        ----------
        x, y
            Points, shape (K,); those that are not finite are left out.
        shape
            Shape of the marks.
        style
            Class in the style sheet.
        """
        r = _MARK_PX
        outline = {
            "circle": f"m-{r} 0a{r} {r} 0 1 0 {2 * r} 0a{r} {r} 0 1 0 -{2 * r} 0",
            "square": f"m-{r} -{r}h{2 * r}v{2 * r}h-{2 * r}z",
        }[shape]
        keep = np.isfinite(x) & np.isfinite(y)
        places = zip(self.x.px(x[keep]), self.y.px(y[keep]), strict=True)
        return _path("".join(f"M{a:.1f} {b:.1f}{outline}" for a, b in places), style)

    def _points(self, x: Array, y: Array) -> str:
        """Return coordinates within a path."""
        places = zip(self.x.px(x), self.y.px(y), strict=True)
        return " ".join(f"{a:.1f} {b:.1f}" for a, b in places)


def drawing(width_px: float, height_px: float, title: str, parts: list[str], style: str) -> str:
    """Return an SVG element.

    Parameters
    ----------
    width_px, height_px
        Size in the drawing's units; the page scales it to its width.
    title
        What it shows, for those who do not see it.
    parts
        What is in it.
    style
        Class in the style sheet.
    """
    return (
        f'<svg class="{style}" viewBox="0 0 {width_px:g} {height_px:g}" role="img" '
        f'aria-label="{escaped(title)}">{"".join(parts)}</svg>'
    )


def _path(d: str, style: str) -> str:
    return f'<path class="{style}" d="{d}"/>' if d else ""


def _text(x: float, y: float, label: str, style: str, turn: str = "") -> str:
    transform = f' transform="{turn}"' if turn else ""
    return f'<text class="{style}" x="{x:.1f}" y="{y:.1f}"{transform}>{escaped(label)}</text>'
