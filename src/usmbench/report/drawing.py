"""What the plots share: how the passes are marked, and the file."""

import warnings
from io import BytesIO
from pathlib import Path

from matplotlib.figure import Figure

from usmbench.errors import InputError
from usmbench.runs.output_files import write_output

CURVE_POINTS = 721
_FORMATS = {".png", ".svg", ".pdf"}
# Rising and falling passes differ in shape as well as in shade: they must be told apart in grey.
PASSES = ((1.0, "^", "rising φ", "0.15"), (-1.0, "v", "falling φ", "0.55"))


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
    InputError
        The file cannot be written, or its format is unknown.
    """
    if path.suffix.lower() not in _FORMATS:
        raise InputError("its ending names no format; give a .png, .svg or .pdf", file=path)
    drawn = BytesIO()
    with warnings.catch_warnings():
        # A run's name may hold letters that the plot's font does not have.
        warnings.filterwarnings("ignore", "Glyph .* missing from font")
        figure.savefig(drawn, dpi=130, format=path.suffix.lower()[1:])
    write_output(path, drawn.getvalue())
