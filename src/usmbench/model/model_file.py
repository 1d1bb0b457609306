"""The model file: YAML that a person can read, with a version that is checked."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from usmbench.errors import CauseError, InputError
from usmbench.model.applied import applied_effects
from usmbench.model.hammerstein import (
    HammersteinModel,
    LinearPart,
    OperatingPoint,
    StaticCurve,
)
from usmbench.model.inverse_map import check_knots
from usmbench.model.linear import poles
from usmbench.runs.output_files import write_output
from usmbench.settings.schema import check
from usmbench.settings.yaml_source import Source, read_source

FORMAT = "usmbench-model"
VERSION = 1
_ROUNDED = 1e-3  # of a gain: as far as it is off where a person rounds a and b
_MOST_BYTES = 50_000_000  # of hundred operating points with all that is known of them


def write_model(path: Path, model: HammersteinModel) -> None:
    """Write a model file.

    Parameters
    ----------
    path
        Where to; an existing file is replaced.
    model
        The model.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    head = f"# A Hammerstein model of a travelling-wave ultrasonic motor, method {model.method}.\n"
    content = to_mapping(model) | {"effects": _Bracketed(model.effects)}
    text = head + yaml.dump(content, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=100)
    write_output(path, text)


def read_model(path: Path) -> HammersteinModel:
    """Read a model file.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    InputError
        The file is missing, no model, of a newer version, or lacks or distorts a value.
    """
    source = read_source(path, _MOST_BYTES)
    _check_format(source.document, path)
    _check_whole(source)
    check(source, "model")
    _check_linear(source)
    for index, point in enumerate(source.document["points"]):
        _check_curve(source, index, point)
    model = replace(from_mapping(source.document), name=str(path))
    try:
        applied_effects(model.effects)
    except CauseError:
        raise  # no fault of the file's
    except InputError as error:
        raise source.error(("effects",), str(error)) from error
    return model


def to_mapping(model: HammersteinModel) -> dict[str, Any]:
    """Return a model as the mapping that its file holds.

    Parameters
    ----------
    model
        The model.
    """
    linear = model.linear
    return {
        "format": f"{FORMAT}/{VERSION}",
        "method": model.method,
        "fitted_on": list(model.fitted_on),
        "linear": {
            "a": linear.a.tolist(),
            "b": linear.b.tolist(),
            "dead_time_windows": linear.dead_time_windows,
            "window_s": linear.window_s,
            "slip_limit_rad_s": linear.slip_limit_rad_s,
        },
        "points": [_point_to_mapping(point) for point in model.points],
        "residual": model.residual,
        "intervals": model.intervals,
        "unexplained": list(model.unexplained),
        "effects": list(model.effects),
    }


def from_mapping(content: dict[str, Any]) -> HammersteinModel:
    """Return the model that a file's mapping describes.

    Parameters
    ----------
    content
        The mapping, as `to_mapping` returns it and the schema has it; unknown keys are ignored.
    """
    linear = content["linear"]
    points = tuple(_point_from_mapping(point) for point in content["points"])
    return HammersteinModel(
        linear=LinearPart(
            a=np.array(linear["a"], dtype=np.float64),
            b=np.array(linear["b"], dtype=np.float64),
            dead_time_windows=int(linear["dead_time_windows"]),
            window_s=_optional(linear["window_s"]),
            slip_limit_rad_s=_optional(linear.get("slip_limit_rad_s")),
        ),
        points=points,
        method=str(content["method"]),
        fitted_on=tuple(content.get("fitted_on") or ()),
        residual=dict(content.get("residual") or {}),
        intervals=dict(content.get("intervals") or {}),
        unexplained=tuple(content.get("unexplained") or ()),
        effects=tuple(content.get("effects") or ()),
    )


def _check_format(content: object, path: Path) -> None:
    """Refuse what is no model, and what a newer usmbench wrote."""
    stated = content.get("format") if isinstance(content, dict) else None
    name, _, version = str(stated).partition("/")
    if name != FORMAT or not re.fullmatch("[0-9]{1,9}", version):
        raise InputError(
            f"is no model file (format is {stated!r}, {FORMAT}/{VERSION} is wanted)", file=path
        )
    if int(version) > VERSION:
        raise InputError(
            f"was written by a newer usmbench (model version {version}, this one reads up to "
            f"{VERSION}); upgrade usmbench",
            file=path,
        )


def _check_whole(source: Source) -> None:
    """Refuse a file without its last key: short of its effects it is the model of another motor."""
    if source.document.get("effects") is None:
        message = (
            "has no key effects: was the file cut off? Copy it again, or identify the model again; "
            "to a model of your own without effects add effects: []"
        )
        raise source.error((), message)


def _check_linear(source: Source) -> None:
    """Refuse dynamics that run away or do nothing, and a torque limit beside anything but a lag."""
    linear = source.document["linear"]
    if linear["a"] and not np.max(np.abs(poles(np.array(linear["a"], dtype=np.float64)))) < 1.0:
        raise source.error(("linear", "a"), "has a pole of size 1 or more: no speed would settle")
    gain = sum(linear["b"]) / (1.0 + sum(linear["a"]))
    if abs(gain) < _ROUNDED:
        message = "adds up to 0: the motor would stand at every phase; give b that add up to 1 + Σa"
        raise source.error(("linear", "b"), message)
    # Beside a torque limit the speed goes to the curve's own, whatever b says.
    lag = len(linear["a"]) == 1 and -1.0 < linear["a"][0] < 0.0 and abs(gain - 1.0) < _ROUNDED
    if linear.get("slip_limit_rad_s") is not None and not (lag and linear["window_s"]):
        raise source.error(
            ("linear", "slip_limit_rad_s"),
            "needs one a between -1 and 0, b that add up to 1 + a, and a window_s; write null for "
            "linear dynamics",
        )


def _check_curve(source: Source, index: int, point: dict[str, Any]) -> None:
    """Refuse knots that do not rise, ordinates that do not belong to them, a range that is none."""
    low_deg, high_deg = point["phase_range_deg"]
    zone_deg = [edge for edge in point["dead_zone_deg"] or () if edge is not None]
    for key, rises in (
        ("phase_range_deg", low_deg < high_deg),
        ("dead_zone_deg", zone_deg == sorted(zone_deg)),
    ):
        if not rises:
            message = "gives the lowest phase first, then the highest"
            raise source.error(("points", index, key), message)
    knots, delta = point["knots_deg"], point["delta_rad_s"]
    if len(knots) != len(delta):
        raise source.error(
            ("points", index, "delta_rad_s"),
            f"has {len(delta)} ordinates for {len(knots)} knots; identify the model again",
        )
    try:
        check_knots(np.array(knots, dtype=np.float64))
    except InputError as error:
        raise source.error(("points", index, "knots_deg"), str(error)) from error


def _point_to_mapping(point: OperatingPoint) -> dict[str, Any]:
    return {
        "frequency_hz": point.frequency_hz,
        "torque_nm": point.torque_nm,
        "phase_range_deg": list(point.phase_range_deg),
        "dead_zone_deg": list(point.dead_zone_deg),
        "noise_rad_s": point.noise_rad_s,
        "knots_deg": point.curve.knots_deg.tolist(),
        "delta_rad_s": point.curve.delta.tolist(),
    }


def _point_from_mapping(content: dict[str, Any]) -> OperatingPoint:
    low_deg, high_deg = (float(value) for value in content["phase_range_deg"])
    edges = content["dead_zone_deg"] or (None, None)
    return OperatingPoint(
        frequency_hz=_optional(content["frequency_hz"]),
        torque_nm=_optional(content["torque_nm"]),
        curve=StaticCurve(
            np.array(content["knots_deg"], dtype=np.float64),
            np.array(content["delta_rad_s"], dtype=np.float64),
        ),
        phase_range_deg=(low_deg, high_deg),
        dead_zone_deg=(_optional(edges[0]), _optional(edges[1])),
        noise_rad_s=float(content["noise_rad_s"]),
    )


def _optional(value: Any) -> float | None:
    return None if value is None else float(value)


class _Bracketed(list[Any]):
    """A list that is no YAML where the file is cut off within it."""


class _Dumper(yaml.SafeDumper):
    """Lists of numbers on one line, everything else in blocks."""


def _one_line_numbers(dumper: yaml.SafeDumper, values: list[Any]) -> yaml.Node:
    flat = all(isinstance(value, int | float | None) for value in values)
    return dumper.represent_sequence("tag:yaml.org,2002:seq", values, flow_style=flat)


def _in_brackets(dumper: yaml.SafeDumper, values: _Bracketed) -> yaml.Node:
    return dumper.represent_sequence("tag:yaml.org,2002:seq", values, flow_style=True)


_Dumper.add_representer(list, _one_line_numbers)
_Dumper.add_representer(_Bracketed, _in_brackets)
