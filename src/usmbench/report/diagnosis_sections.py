"""What the diagnosis page says, section by section."""

from collections.abc import Sequence

import numpy as np

from usmbench.diagnose.result import Diagnosis, Trace, View
from usmbench.report.diagnosis_figures import legend, trace_figure, view_figure
from usmbench.report.diagnosis_tables import candidates_table, plan_text, table
from usmbench.report.diagnosis_text import escaped
from usmbench.report.error_text import noise_note, what_is_left
from usmbench.report.experiment_text import odds_of, why_no_experiment
from usmbench.report.numbers_text import number, percent, spelled, times

_MOST_TRACES = 6
_WITH_CAUSE = "simulation with the cause in it"
_OF_THE_ERROR = (
    "A share of the error above the noise is one of its mean square above that of the noise: where "
    "75 % are removed, what is left of the error beyond the noise is half as large."
)
_PARTLY = (
    " Where a second, larger number follows, that is the whole drop, and only the first speaks for "
    "the cause: what the model may be off by explains the rest as well, or counts should be lost "
    "by chance and do not scatter."
)


def figures_section(diagnosis: Diagnosis) -> str:
    """Return the figures to remember.

    Parameters
    ----------
    diagnosis
        What was found.
    """
    entries = [
        (
            "Error of the simulation",
            f"{number(diagnosis.rmse_simulation_rad_s)} rad/s",
            "root mean square, free-running",
        ),
        (
            "Noise of the bench",
            f"{number(diagnosis.noise_floor_rad_s)} rad/s",
            noise_note(diagnosis),
        ),
    ]
    if diagnosis.foretells:
        interval = f"{percent(diagnosis.gain_low)} … {percent(diagnosis.gain_high)}"
        extended = f"{number(diagnosis.rmse_extended_rad_s)} rad/s"
        entries[1:1] = [("Error with the cause in it", extended, "on data the fit never saw")]
        entries.append(
            ("Gain", percent(diagnosis.gain), f"{interval}, of the error above the noise")
        )
    cells = "".join(
        f"<div><dt>{name}</dt><dd>{value}<small>{note}</small></dd></div>"
        for name, value, note in entries
    )
    share = f'<p class="note">{_OF_THE_ERROR}</p>' if diagnosis.foretells else ""
    return f'<dl class="figures">{cells}</dl>{share}'


def traces_section(diagnosis: Diagnosis) -> str:
    """Return the runs, measured against simulated.

    Parameters
    ----------
    diagnosis
        What was found.
    """
    extended = diagnosis.foretells
    above = [("measured", "measured"), ("before", "simulation")]
    below = [("before dense", "what the simulation leaves")]
    if extended:
        above.append(("after", _WITH_CAUSE))
        below.append(("after dense", f"what the {_WITH_CAUSE} leaves"))
    shown = diagnosis.traces[:_MOST_TRACES]
    figures = "".join(_trace(trace, extended=extended) for trace in shown)
    more = len(diagnosis.traces) - len(shown)
    rest = f'<p class="note">{more} more stretches are not drawn.</p>' if more else ""
    return (
        '<h2 id="runs">Measured against simulated</h2>'
        '<p class="how">Above, the speed; below, what each simulation leaves of it. The '
        "simulation runs free: it is given the commands and never the measured speed. What lies "
        "beyond the axis is drawn at its edge.</p>"
        f"{legend(*above, *below)}{figures}{rest}"
    )


def _trace(trace: Trace, *, extended: bool) -> str:
    figure = trace_figure(trace, extended=extended)
    return f"<figure><figcaption>{escaped(trace.name)}</figcaption>{figure}</figure>"


def views_section(diagnosis: Diagnosis) -> str:
    """Return the residual against each quantity, first what tells most of the named causes.

    Parameters
    ----------
    diagnosis
        What was found.
    """
    extended = diagnosis.foretells
    entries = [("band", "band of a run that is as simulated"), ("before marked", "simulation")]
    if extended:
        entries.append(("after marked", _WITH_CAUSE))
    views: Sequence[View] = diagnosis.views
    first = "that leaves its band farthest"
    if extended:
        views = sorted(views, key=_taken_square, reverse=True)
        first = "in which the cause shows most"
    figures = "".join(_view(view, extended=extended) for view in views)
    return (
        '<h2 id="views">What gave it away</h2>'
        '<p class="how">Measured less simulated speed, averaged, without what the simulation '
        "misses on its own runs. Noise, and what healthy runs differ by, keep all points of a "
        "figure within its grey band in 95 of 100 runs; 1 × is at the band's edge. The figure "
        f'{first} comes first.</p>{legend(*entries)}<div class="views">{figures}</div>'
    )


def _taken_square(view: View) -> float:
    """Sum of squares of what the named causes take out of a view, in (rad/s)².

    Not in units of its band: a narrow one is left by what hardly is there.
    """
    return float(np.sum(view.n_windows * (view.before_rad_s - view.after_rad_s) ** 2))


def _view(view: View, *, extended: bool) -> str:
    """Return a figure under its caption."""
    beyond = f"{times(view.excess_before)} its band"
    if extended:
        beyond += f", with the cause {times(view.excess_after)}"
    return (
        f"<figure><figcaption><b>Against {escaped(view.versus)}</b>: {beyond}{_remark(view)}"
        f"</figcaption>{view_figure(view, extended=extended)}</figure>"
    )


def _remark(view: View) -> str:
    """Say what the axis has no room for."""
    remark = view.label.partition(", ")[2]
    return f" <span>({escaped(remark)})</span>" if remark else ""


def evidence_section(diagnosis: Diagnosis) -> str:
    """Return the evidence for the cause and its rivals.

    Parameters
    ----------
    diagnosis
        What was found.
    """
    refused = "".join(
        f"<li>{escaped(spelled(name))}: {escaped(why)}</li>" for name, why in diagnosis.not_testable
    )
    untested = f"<h3>Not testable with these runs</h3><ul>{refused}</ul>" if refused else ""
    partly = _PARTLY if any(c.misfit for c in diagnosis.candidates) else ""
    return (
        '<h2 id="evidence">Evidence, cause by cause</h2>'
        '<p class="how">Each cause of the library, fitted alone. Evidence is by how much the cause '
        "lowers the sum of the squares of what is left, in units of the noise that is usual there."
        f"{partly} p is the probability that the whole library would show as much evidence, with "
        "as many parameters, where nothing is wrong.</p>"
        f"{candidates_table(diagnosis)}{untested}"
    )


def remainder_section(diagnosis: Diagnosis) -> str:
    """Return what remains.

    Parameters
    ----------
    diagnosis
        What was found.
    """
    return f'<h2 id="remainder">What is left</h2><p>{escaped(what_is_left(diagnosis))}</p>'


def driven_section(driven: Sequence[tuple[str, str]]) -> str:
    """Return the experiments that led here.

    Parameters
    ----------
    driven
        Of each experiment that was driven, the run and what it was to show.
    """
    if not driven:
        return ""
    rows = [("", (escaped(run), escaped(says))) for run, says in driven]
    return (
        '<h2 id="driven">Experiments that were driven</h2><p class="how">Each was proposed by the '
        "diagnosis of the runs before it; this page is about all of them together.</p>"
        f"{table(('Run', 'Why'), rows)}"
    )


def next_section(diagnosis: Diagnosis) -> str:
    """Return the experiment that would decide.

    Parameters
    ----------
    diagnosis
        What was found.
    """
    proposal = diagnosis.next_experiment
    if proposal is None:
        why = why_no_experiment(diagnosis)
        return f'<h2 id="next">The next experiment</h2><p>{why[0].upper()}{why[1:]}.</p>'
    odds, said = odds_of(proposal), ""
    if odds is not None:
        said = (
            f"<p>Odds of telling them apart: <b>{odds[0]}</b> with these runs, "
            f"<b>{odds[1]}</b> with that sweep, if the simulation is right in all else.</p>"
        )
    return (
        f'<h2 id="next">The next experiment</h2><p>{escaped(proposal["says"])}</p>{said}'
        "<p>Save this as <code>next.yaml</code> and run <code>usmbench sweep next.yaml --bench "
        f"BENCH.yaml</code>; then diagnose the new run together with these.</p>"
        f"<pre>{plan_text(proposal['plan'])}</pre>"
    )
