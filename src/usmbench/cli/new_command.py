"""``usmbench new``: a commented plan, bench or mapping file to start from."""

import argparse
import os
import sys
from pathlib import Path

from usmbench.errors import InputError
from usmbench.runs.output_files import write_output
from usmbench.settings.starting_files import KINDS, template


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments.

    Parameters
    ----------
    parser
        The subcommand's parser.
    """
    parser.add_argument("kind", choices=list(KINDS), help="what the file is to say")
    parser.add_argument(
        "file",
        metavar="FILE",
        nargs="?",
        help="the file to make [plan.yaml, bench.yaml, mapping.yaml]; - is standard output",
    )


def run(args: argparse.Namespace) -> int:
    """Write a file; one that exists is left alone.

    Parameters
    ----------
    args
        The parsed arguments.

    Raises
    ------
    usmbench.errors.InputError
        The file exists, or cannot be written.
    """
    text = template(args.kind)
    if args.file == "-":
        sys.stdout.write(text)
        return 0
    file = Path(args.file or KINDS[args.kind][1])
    if os.path.lexists(file):
        raise InputError("exists already; name another file", file=file)
    write_output(file, text)
    print(file)
    return 0
