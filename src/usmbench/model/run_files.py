"""Runs as files of other tools: CSV, Parquet, NetCDF, and MATLAB's."""

from collections.abc import Callable
from io import BytesIO
from pathlib import Path

from usmbench.model.interop import to_pandas, to_xarray, write_mat
from usmbench.model.other_tools import field_names, package
from usmbench.runs.output_files import write_output
from usmbench.runs.record import Record


def write_csv(path: Path, record: Record) -> None:
    """Write a run as one CSV file, with the columns that were derived.

    Parameters
    ----------
    path
        The file; an existing one is replaced.
    record
        The run.

    Raises
    ------
    InputError
        pandas is not installed, or the file cannot be written.
    """
    write_output(path, to_pandas(record).to_csv(float_format="%.12g"))


def write_parquet(path: Path, record: Record) -> None:
    """Write a run as Parquet, units and run.yaml in the file's metadata.

    Parameters
    ----------
    path
        The file; an existing one is replaced.
    record
        The run.

    Raises
    ------
    InputError
        pandas or pyarrow is not installed, or the file cannot be written.
    """
    package("pyarrow")
    write_output(path, to_pandas(record).to_parquet(engine="pyarrow"))


def write_netcdf(path: Path, record: Record) -> None:
    """Write a run as NetCDF 4, each variable with its units.

    A name of the user's own that NetCDF cannot take has `_` for what is wrong in it, and stands
    whole in the variable's `long_name`.

    Parameters
    ----------
    path
        The file; an existing one is replaced.
    record
        The run.

    Raises
    ------
    InputError
        xarray or h5netcdf is not installed, or the file cannot be written.
    """
    h5netcdf = package("h5netcdf")
    data = to_xarray(record)
    names = field_names([str(name) for name in data.variables])
    for name, field in names.items():
        if field != name:
            data[name].attrs["long_name"] = name
    data = data.rename({name: field for name, field in names.items() if field != name})
    # In memory: HDF5 brings the process down where the disk has no room for its file.
    content = BytesIO()
    with h5netcdf.File(content, "w") as file:
        data.dump_to_store(package("xarray").backends.H5NetCDFStore(file))
    write_output(path, content.getvalue())


# What each format of `usmbench export` is written by.
WRITERS: dict[str, Callable[[Path, Record], None]] = {
    "csv": write_csv,
    "mat": write_mat,
    "netcdf": write_netcdf,
    "parquet": write_parquet,
}
