"""An identification as a person reads it on a terminal."""

from typing import Any

from usmbench.identify.result import Identification, Scores
from usmbench.model.effects.first_order import true_dead_time_s
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint
from usmbench.model.linear import time_constant_s

_WIDTH = 22


def identification_table(found: Identification) -> str:
    """Return the report of an identification.

    Parameters
    ----------
    found
        The identification.

    Returns
    -------
    str
        Several lines without a newline at the end; intervals are 95 %.
    """
    model = found.model
    n = sum(score.n for score in found.scores)
    lines = [
        _line("method", f"{model.method}, {n} samples, {found.fit_s:.2f} s"),
        *_dynamics(model),
    ]
    own = model.intervals.get("points") or [{}] * len(model.points)
    for point, score, intervals in zip(model.points, found.scores, own, strict=True):
        lines += ["", *_point(point, score, intervals)]
    if found.tests:
        lines += ["", "still in the residual"]
    for test in found.tests:
        verdict = f"yes (p = {test.p_value:.2g})" if test.p_value < 0.01 else "not seen"
        lines.append(_line(f"  {verdict}", test.question))
    return "\n".join(lines)


def _dynamics(model: HammersteinModel) -> list[str]:
    """Lines about the linear part."""
    linear, intervals = model.linear, model.intervals
    tau_s, dead_s = time_constant_s(linear), true_dead_time_s(linear)
    lines = [
        _line("a", _numbers(linear.a.tolist())),
        _line("b", f"{_numbers(linear.b.tolist())}  (gain {linear.gain:.6g})"),
    ]
    if tau_s is not None:
        lines.append(_line("time constant", _milliseconds(tau_s, intervals.get("tau_s"))))
    if dead_s is not None:
        lines.append(_line("dead time", _milliseconds(dead_s, intervals.get("dead_time_s"))))
    if linear.slip_limit_rad_s is not None:
        own = _interval(intervals.get("slip_limit_rad_s"), 1.0, ".2f")
        limit = f"gives out at a slip of {linear.slip_limit_rad_s:.2f} rad/s{own}"
        lines.append(_line("torque", limit))
    return lines


def _point(point: OperatingPoint, score: Scores, intervals: dict[str, Any]) -> list[str]:
    """Lines about one operating point."""
    low_deg, high_deg = point.phase_range_deg
    edges = ("dead_zone_low_deg", "dead_zone_high_deg")
    zone = ", ".join(
        "no edge" if edge is None else f"{edge:.2f}°{_interval(intervals.get(key), 1.0, '.2f')}"
        for edge, key in zip(point.dead_zone_deg, edges, strict=True)
    )
    lines = [
        _heading(point),
        _line("  curve", f"degree {point.curve.degree}, φ from {low_deg:g}° to {high_deg:g}°"),
        _line("  dead zone", zone),
    ]
    gain = intervals.get("gain_rad_s")
    if gain is not None:
        value = f"{0.5 * (gain[0] + gain[1]):.3f} rad/s{_interval(gain, 1.0, '.3f')}"
        lines.append(_line("  highest speed", value))
    return [
        *lines,
        _line("  RMSE, one step", f"{score.rmse_one_step_rad_s:.4g} rad/s"),
        _line("  RMSE, free-running", f"{score.rmse_free_run_rad_s:.4g} rad/s"),
        _line("  SSE", f"{score.sse:.4g} (rad/s)² over {score.n} samples"),
    ]


def _line(name: str, value: str) -> str:
    return f"{name:<{_WIDTH}} {value}"


def _heading(point: OperatingPoint) -> str:
    """Name the operating point."""
    frequency = "" if point.frequency_hz is None else f" {point.frequency_hz:g} Hz"
    torque = "" if point.torque_nm is None else f" {point.torque_nm:g} N·m"
    return f"operating point{frequency}{torque}"


def _milliseconds(value_s: float, interval_s: list[float] | None) -> str:
    return f"{1e3 * value_s:.3f} ms{_interval(interval_s, 1e3, '.3f')}"


def _interval(interval: list[float] | None, factor: float, form: str) -> str:
    """Write an interval in brackets, or nothing where there is none."""
    if interval is None:
        return ""
    low, high = (f"{factor * end:{form}}" for end in interval)
    return f"  [{low}, {high}]"


def _numbers(values: list[float]) -> str:
    """Write a short list of numbers."""
    return ", ".join(f"{value:.5g}" for value in values) or "none"
