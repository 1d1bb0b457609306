"""The paper's search, iteration by iteration, as a table for any spreadsheet."""

import csv
from collections.abc import Sequence
from io import StringIO
from pathlib import Path

from usmbench.identify.paper_lm import LmStep
from usmbench.runs.output_files import write_output

HEADER = ("iteration", "sse", "mu", "lambda", "accepted")


def write_trace(path: Path, trace: Sequence[LmStep]) -> None:
    """Write a CSV file with one row an iteration.

    Parameters
    ----------
    path
        The file; an existing one is replaced.
    trace
        The iterations. `sse` is in (rad/s)², of the trial also where it was refused; `mu` is the
        damping the step was made with and `lambda` its gain ratio.

    Raises
    ------
    usmbench.errors.InputError
        The file cannot be written.
    """
    text = StringIO()
    table = csv.writer(text)
    table.writerow(HEADER)
    table.writerows(
        (step.iteration, step.sse, step.damping, step.gain_ratio, int(step.accepted))
        for step in trace
    )
    write_output(path, text.getvalue())
