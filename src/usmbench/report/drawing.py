"""What the plots share: how the passes are marked, and the file."""

import warnings
from io import BytesIO
from pathlib import Path

from matplotlib.figure import Figure

from usmbench.report.plot_format import plot_format
from usmbench.runs.output_files import write_output
from usmbench.runs.pauses import without_pauses_s
from usmbench.runs.record import Column, Record

CURVE_POINTS = 721
# Rising and falling passes differ in shape as well as in shade: they must be told apart in grey.
PASSES = ((1.0, "^", "rising φ", "0.15"), (-1.0, "v", "falling φ", "0.55"))


def shown_time(record: Record) -> tuple[Column, str]:
    """Return the time to draw a run over, and its label.

    Parameters
    ----------
    record
        The run. Pauses are left out: a night beside a sweep of a minute would hide it.
    """
    window_s = record.usual_window_s
    shown_s = without_pauses_s(record.t_s, window_s)
    paused = bool(record.t_s[-1] - shown_s[-1] > window_s)
    return shown_s, "time without pauses (s)" if paused else "time (s)"


def save_figure(figure: Figure, path: Path) -> None:
    """Write a figure, with the errors a user can mend.

    Parameters
    ----------
    figure
        The figure.
    path
        The file; its ending is the format.

    Raises
    ------
    usmbench.errors.InputError
        The file cannot be written, or its format is unknown.
    """
    drawn, ending = BytesIO(), plot_format(path)
    with warnings.catch_warnings():
        # A run's name may hold letters that the plot's font does not have.
        warnings.filterwarnings("ignore", "Glyph .* missing from font")
        figure.savefig(drawn, dpi=130, format=ending)
    write_output(path, drawn.getvalue())
