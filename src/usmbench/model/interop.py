"""Models and runs for other tools: python-control, scipy.signal, pandas, xarray, MATLAB.

Their packages are imported where they are used: none is needed to run the bench.
"""

from dataclasses import fields
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import yaml
from numpy.typing import NDArray
from scipy.io import savemat
from scipy.signal import TransferFunction

from usmbench.model.hammerstein import HammersteinModel, LinearPart
from usmbench.model.other_tools import field_names, package
from usmbench.runs.output_files import escaped, write_output
from usmbench.runs.record import Pairs, Record

if TYPE_CHECKING:
    import control
    import pandas as pd
    import xarray as xr

Array = NDArray[np.float64]

_UNITS = {
    "phase_deg": "deg",
    "speed_rad_s": "rad/s",
    "window_s": "s",
    "frequency_hz": "Hz",
    "torque_nm": "N·m",
    "angle_rad": "rad",
    "sweep": "1",
    "settled": "1",
    "temperature_c": "°C",
}


def to_scipy(linear: LinearPart) -> TransferFunction:
    """Return the linear part as a discrete system of scipy.signal.

    Parameters
    ----------
    linear
        The linear part; its dead time becomes zeros before b.

    Returns
    -------
    scipy.signal.TransferFunction
        Discrete, in z; without a time step (settled pairs) its step is 1.
    """
    numerator, denominator = _polynomials(linear)
    step_s = 1.0 if linear.window_s is None else linear.window_s
    return TransferFunction(numerator, denominator, dt=step_s)


def to_control(linear: LinearPart) -> "control.TransferFunction":
    """Return the linear part as a transfer function of python-control.

    Parameters
    ----------
    linear
        The linear part; its dead time becomes zeros before b.

    Returns
    -------
    control.TransferFunction
        In z; without a time step (settled pairs) its step is unspecified.

    Raises
    ------
    InputError
        python-control is not installed.
    """
    numerator, denominator = _polynomials(linear)
    step: Any = True if linear.window_s is None else linear.window_s
    return package("control").TransferFunction(numerator, denominator, step)


def to_pandas(record: Record) -> "pd.DataFrame":
    """Return a run as a table, one row a window, indexed by time.

    Parameters
    ----------
    record
        The run.

    Returns
    -------
    pandas.DataFrame
        The columns that the run has, with their names in the run folder; index `t_s`. Units, name
        and run.yaml are in `attrs`.

    Raises
    ------
    InputError
        pandas is not installed.
    """
    pandas = package("pandas")
    index = pandas.Index(record.t_s, name="t_s")
    table: pd.DataFrame = pandas.DataFrame(_columns(record), index=index)
    table.attrs = {**_about(record), "units": {"t_s": "s", **_UNITS}}
    return table


def to_xarray(record: Record) -> "xr.Dataset":
    """Return a run as a labelled data set over time, with units.

    Parameters
    ----------
    record
        The run.

    Returns
    -------
    xarray.Dataset
        One variable a column over `t_s`, each with its `units`; name and run.yaml are attributes.

    Raises
    ------
    InputError
        xarray is not installed.
    """
    xarray = package("xarray")
    variables = {
        name: ("t_s", column, {"units": _UNITS[name]} if name in _UNITS else {})
        for name, column in _columns(record).items()
    }
    time = ("t_s", record.t_s, {"units": "s"})
    data: xr.Dataset = xarray.Dataset(variables, coords={"t_s": time}, attrs=_about(record))
    return data


def write_mat(
    path: Path, record: Record | None = None, model: HammersteinModel | None = None
) -> None:
    """Write a run, a model, or both for MATLAB.

    Parameters
    ----------
    path
        The .mat file (version 5); an existing one is replaced.
    record
        Becomes the struct `run`, a column vector a column, and the struct `pairs`. A name of the
        user's own that MATLAB cannot take has `_` for what is wrong in it.
    model
        Becomes the struct `model`: `a`, `b`, `dead_time_windows`, `window_s` (NaN for settled
        pairs), and a struct array `points` with `frequency_hz`, `torque_nm`, `knots_deg`, `delta`.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    content: dict[str, Any] = {}
    if record is not None:
        columns = {"t_s": record.t_s, **_columns(record)}
        names = field_names(columns)
        content["run"] = {names[name]: column for name, column in columns.items()}
        if record.pairs is not None:
            content["pairs"] = {
                part.name: getattr(record.pairs, part.name) for part in fields(Pairs)
            }
    if model is not None:
        content["model"] = _model_struct(model)
    file: Any = BytesIO()  # which the stubs of savemat do not know of
    savemat(file, content, oned_as="column", long_field_names=True)
    write_output(path, file.getvalue())


def _model_struct(model: HammersteinModel) -> dict[str, Any]:
    """Nest a model as MATLAB reads it; NaN stands for what is not known."""
    linear, limit = model.linear, model.linear.slip_limit_rad_s
    points = [
        {
            "frequency_hz": np.nan if point.frequency_hz is None else point.frequency_hz,
            "torque_nm": np.nan if point.torque_nm is None else point.torque_nm,
            "knots_deg": point.curve.knots_deg,
            "delta": point.curve.delta,
        }
        for point in model.points
    ]
    return {
        "a": linear.a,
        "b": linear.b,
        "dead_time_windows": linear.dead_time_windows,
        "window_s": np.nan if linear.window_s is None else linear.window_s,
        "slip_limit_rad_s": np.inf if limit is None else limit,
        "points": points,
    }


def _polynomials(linear: LinearPart) -> tuple[Array, Array]:
    """Numerator and denominator in falling powers of z, of equal length."""
    numerator = np.concatenate([np.zeros(linear.dead_time_windows), linear.b])
    denominator = np.concatenate([[1.0], linear.a])
    length = max(numerator.size, denominator.size)
    padded = (np.pad(p, (0, length - p.size)) for p in (numerator, denominator))
    top, bottom = padded
    return np.trim_zeros(top, "f"), bottom


def _columns(record: Record) -> dict[str, Any]:
    """Columns that a run has, the user's own among them."""
    columns = {name: getattr(record, name) for name in _UNITS}
    return {name: column for name, column in columns.items() if column is not None} | record.extra


def _about(record: Record) -> dict[str, str]:
    """Return what a file says of a run beside its columns."""
    run_yaml = yaml.safe_dump(record.meta, sort_keys=False, allow_unicode=True)
    return {"name": escaped(record.name), "run_yaml": run_yaml}
