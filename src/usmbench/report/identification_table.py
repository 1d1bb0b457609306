"""An identification as a person reads it on a terminal."""

from usmbench.identify.result import Identification
from usmbench.model.hammerstein import OperatingPoint
from usmbench.model.linear import time_constant_s


def identification_table(found: Identification) -> str:
    """Return the report of an identification.

    Parameters
    ----------
    found
        The identification.

    Returns
    -------
    str
        Several lines, none longer than 100 characters, without a newline at the end.
    """
    model, linear = found.model, found.model.linear
    tau_s = time_constant_s(linear)
    rows = [
        (
            "method",
            f"{model.method}, {sum(s.n for s in found.scores)} samples, {found.fit_s:.2f} s",
        ),
        ("a", _numbers(linear.a.tolist())),
        ("b", _numbers(linear.b.tolist())),
        ("gain of the linear part", f"{linear.gain:.6g}"),
        ("time constant", "none" if tau_s is None else f"{1e3 * tau_s:.3f} ms"),
        ("dead time", f"{linear.dead_time_windows} windows"),
    ]
    lines = [f"{name:<24} {value}" for name, value in rows]
    for point, score in zip(model.points, found.scores, strict=True):
        lines += [
            "",
            _heading(point),
            f"  degree {point.curve.degree}, φ from {point.phase_range_deg[0]:g}° to "
            f"{point.phase_range_deg[1]:g}°, dead zone {_edges(point)}",
            f"  RMSE {score.rmse_one_step_rad_s:.4g} rad/s one step ahead, "
            f"{score.rmse_free_run_rad_s:.4g} rad/s free-running; SSE {score.sse:.4g} (rad/s)²",
        ]
    return "\n".join(lines)


def _heading(point: OperatingPoint) -> str:
    """Name the operating point."""
    frequency = "" if point.frequency_hz is None else f" {point.frequency_hz:g} Hz"
    torque = "" if point.torque_nm is None else f" {point.torque_nm:g} N·m"
    return f"operating point{frequency}{torque}" if frequency or torque else "operating point"


def _edges(point: OperatingPoint) -> str:
    """Write the dead zone's edges."""
    low_deg, high_deg = point.dead_zone_deg
    if low_deg is None and high_deg is None:
        return "not seen"
    low = "…" if low_deg is None else f"{low_deg:.2f}°"
    high = "…" if high_deg is None else f"{high_deg:.2f}°"
    return f"{low} to {high}"


def _numbers(values: list[float]) -> str:
    """Write a short list of numbers."""
    return ", ".join(f"{value:.5g}" for value in values) or "none"
