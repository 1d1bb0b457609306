"""The usmbench command: one module a subcommand, one line an error."""

import argparse
import importlib
import os
import sys
from collections.abc import Sequence
from io import TextIOWrapper
from pathlib import Path
from typing import NoReturn

from usmbench import __version__
from usmbench.errors import InputError, UsmbenchError
from usmbench.one_line_parser import OneLineParser
from usmbench.output import complain, drop_output

STOPPED_BY_USER = 130

# name: one line of help; the module usmbench.cli.<name>_command has add_arguments() and run().
COMMANDS = {
    "sweep": "drive the testbed through a plan and write a run folder",
    "identify": "from runs to a model of the motor",
    "watch": "the live page of a run, with a button that stops it",
    "replay": "a run's commands through a model, or through a bench again",
    "diagnose": "what the simulation gets wrong, why, and what it gains to know",
    "runs": "list what was measured, find it, check its data",
    "show": "one run in some lines and a plot",
    "compare": "two runs, setting by setting",
    "doctor": "walk through a bench: what each part says, and what to do about it",
    "export": "a run as Parquet, MATLAB, NetCDF or CSV",
    "import": "somebody else's CSV or .mat as a run folder",
    "new": "a commented plan, bench or mapping file to start from",
    "demo": "all of it on the simulated testbed",
}

_DESCRIPTION = (
    "Bench stack for travelling-wave ultrasonic motors: drive one through a sweep, identify a "
    "model of it, and find what that model gets wrong, and why. A run is a folder, or a CSV file."
)

# Options whose value is a list of numbers, such as -90,0,90.
LIST_OPTIONS = {"--knots"}


def build_parser(command: str | None = None) -> argparse.ArgumentParser:
    """Return the parser.

    Parameters
    ----------
    command
        The only subcommand whose arguments are wanted: importing the others costs a second.
    """
    parser = OneLineParser(prog="usmbench", description=_DESCRIPTION)
    parser.add_argument("--version", action="version", version=f"usmbench {__version__}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, summary in COMMANDS.items():
        sub = commands.add_parser(name, help=summary, description=summary)
        if name == command:
            module = importlib.import_module(f"usmbench.cli.{name}_command")
            module.add_arguments(sub)
            sub.set_defaults(run=module.run)
    return parser


def _joined(words: Sequence[str]) -> list[str]:
    """Join a list to its option: argparse takes a value that starts with a minus for another."""
    joined: list[str] = []
    for word in words:
        if joined and joined[-1] in LIST_OPTIONS:
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status.

    Parameters
    ----------
    arguments
        The command line without the program's name; None takes it from the process.
    """
    _prepare_output()
    words = _joined(sys.argv[1:] if arguments is None else arguments)
    command = next((word for word in words if word in COMMANDS), None)
    try:
        return _run(words, command)
    except UsmbenchError as error:
        notes = getattr(error, "__notes__", [])
        complain("; ".join([f"usmbench: {error}", *notes]))
        return error.exit_status
    except KeyboardInterrupt as wish:
        # Who stopped it, where that was not Ctrl-C.
        complain(f"usmbench: {str(wish) or 'stopped by the user'}")
        return STOPPED_BY_USER
    except BrokenPipeError:
        # The reader of our output has gone (a pager that was quit): nothing left to say.
        drop_output()
        return 0
    except OSError as error:
        drop_output()
        where = error.filename or "standard output"
        complain(f"usmbench: {where}: {error.strerror or error}; look at it")
        return InputError.exit_status


def _run(words: Sequence[str], command: str | None) -> int:
    """Run the command, and print all that it says."""
    _refuse_empty(words)
    parsed, unknown = build_parser(command).parse_known_args(words)
    if unknown:
        said = f"unrecognized arguments: {' '.join(unknown)}"
        raise InputError(f"{said} (see `usmbench {parsed.command} --help`)")
    status = int(parsed.run(parsed))
    sys.stdout.flush()
    return status


def _refuse_empty(words: Sequence[str]) -> None:
    """Refuse an argument without a value, such as a variable that a script forgot to set."""
    for before, word in zip(["", *words], words, strict=False):
        name, equals, value = word.partition("=")
        if name.startswith("--") and equals and not value:
            what = name
        elif not word:
            what = before if before.startswith("--") else "an argument"
        else:
            continue
        raise InputError(f"{what} is empty; give it a value, or leave it out")


def _prepare_output() -> None:
    """Open what was closed (``>&-``), and show what cannot be encoded as a question mark."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            # Takes the closed descriptor's place, which a data file would get otherwise.
            nowhere = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115 - to the end
            setattr(sys, name, nowhere)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")


def entry_point() -> NoReturn:
    """Run the command of this process and exit with its status."""
    # Set before numpy is imported. Our matrices are small: threads that wait for each other took
    # twenty times longer on two busy cores.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.exit(main())
