"""Models and runs for other tools: python-control, scipy.signal, pandas, xarray, MATLAB.

The three packages are imported where they are used: none is needed to run the bench.
"""

import importlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.io import savemat
from scipy.signal import TransferFunction

from usmbench.errors import InputError
from usmbench.model.hammerstein import HammersteinModel, LinearPart
from usmbench.runs.record import Record

if TYPE_CHECKING:
    import control
    import pandas as pd
    import xarray as xr

Array = NDArray[np.float64]

_COLUMNS = {
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
    return _package("control").TransferFunction(numerator, denominator, step)


def to_pandas(record: Record) -> "pd.DataFrame":
    """Return a run as a table, one row a window, indexed by time.

    Parameters
    ----------
    record
        The run.

    Returns
    -------
    pandas.DataFrame
        The columns that the run has, with their names in the run folder; index `t_s`.

    Raises
    ------
    InputError
        pandas is not installed.
    """
    pandas = _package("pandas")
    index = pandas.Index(record.t_s, name="t_s")
    return pandas.DataFrame(_columns(record), index=index)


def to_xarray(record: Record) -> "xr.Dataset":
    """Return a run as a labelled data set over time, with units.

    Parameters
    ----------
    record
        The run.

    Returns
    -------
    xarray.Dataset
        One variable a column over `t_s`, each with its `units`; the name is an attribute.

    Raises
    ------
    InputError
        xarray is not installed.
    """
    xarray = _package("xarray")
    variables = {
        name: ("t_s", column, {"units": _COLUMNS[name]})
        for name, column in _columns(record).items()
    }
    time = ("t_s", record.t_s, {"units": "s"})
    data: xr.Dataset = xarray.Dataset(variables, coords={"t_s": time}, attrs={"name": record.name})
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
        Becomes the struct `run`, a column vector a column.
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
        content["run"] = {"t_s": record.t_s, **_columns(record)}
    if model is not None:
        content["model"] = _model_struct(model)
    try:
        savemat(path, content, oned_as="column")
    except OSError as error:
        raise InputError(
            f"cannot be written ({error.strerror}); give a file in a folder that exists", file=path
        ) from error


def _model_struct(model: HammersteinModel) -> dict[str, Any]:
    """Nest a model as MATLAB reads it; NaN stands for what is not known."""
    linear = model.linear
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


def _columns(record: Record) -> dict[str, Array]:
    """Columns that a run has."""
    columns = {name: getattr(record, name) for name in _COLUMNS}
    return {name: column for name, column in columns.items() if column is not None}


def _package(name: str) -> Any:
    """Import a package that only this module uses."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise InputError(
            f"{name} is not installed; install it with `pip install usmbench[interop]`"
        ) from error
