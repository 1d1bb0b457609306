"""``usmbench export``: a run for another tool."""

import argparse
from pathlib import Path

from usmbench.errors import InputError
from usmbench.model.run_files import WRITERS
from usmbench.output import warn
from usmbench.runs.check_record import changed_since_closed
from usmbench.runs.output_paths import check_outputs
from usmbench.runs.reader import read_run

_ENDINGS = {".csv": "csv", ".mat": "mat", ".nc": "netcdf", ".parquet": "parquet"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments.

    Parameters
    ----------
    parser
        The subcommand's parser.
    """
    parser.add_argument("recorded", metavar="RUN", type=Path, help="run folder or CSV")
    parser.add_argument("file", metavar="FILE", type=Path, help="the file to write")
    parser.add_argument(
        "--to",
        choices=sorted(WRITERS),
        help=f"its format; without, by the file's ending: {', '.join(_ENDINGS)}",
    )


def run(args: argparse.Namespace) -> int:
    """Write a run in another format.

    Parameters
    ----------
    args
        The parsed arguments.

    Raises
    ------
    usmbench.errors.InputError
        The run cannot be read, the file cannot be written, or a package is not installed.
    """
    file: Path = args.file
    to = args.to or _ENDINGS.get(file.suffix.casefold())
    if to is None:
        raise InputError(
            f"its ending does not say the format; add --to {'|'.join(sorted(WRITERS))}", file=file
        )
    check_outputs({"FILE": file}, [args.recorded])
    record = read_run(args.recorded)
    WRITERS[to](file, record)
    warn(changed_since_closed([record]))
    print(file)
    return 0
