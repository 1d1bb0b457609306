"""The report's section on windows that stand alone."""

from math import isinf

from usmbench.diagnose.result import Diagnosis, LoneView
from usmbench.report.diagnosis_figures import marks_figure
from usmbench.report.diagnosis_text import escaped
from usmbench.report.numbers_text import number, spelled


def lone_section(diagnosis: Diagnosis) -> str:
    """Return the windows that stand alone, of each cause that is named for them.

    Parameters
    ----------
    diagnosis
        The diagnosis.
    """
    if not diagnosis.lone_views:
        return ""
    figures = "".join(_figure(view) for view in diagnosis.lone_views)
    return (
        '<h2 id="lone">Windows that stand alone</h2>'
        '<p class="how">Each mark is a window that is far from those beside it while the motor '
        "runs on: by how much its speed is off, against what sets such windows apart from others. "
        "The evidence against a cause is twice the log-likelihood by which it is behind.</p>"
        f'<div class="views">{figures}</div>'
    )


def _figure(view: LoneView) -> str:
    """Return a figure under its caption."""
    n = view.at.size
    return (
        f"<figure><figcaption><b>{escaped(spelled(view.cause))}</b>: {n} "
        f"window{'' if n == 1 else 's'}{_rivals(view)}</figcaption>{marks_figure(view)}</figure>"
    )


def _rivals(view: LoneView) -> str:
    """Say what speaks against the other causes."""
    behind = ", ".join(
        f"{escaped(spelled(name))} {'does not fit' if isinf(less) else number(less)}"
        for name, less in view.rivals
    )
    return f". Evidence against others: {behind}" if behind else ""
