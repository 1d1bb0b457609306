"""What the diagnosis page says, section by section."""

from collections.abc import Sequence

from usmbench.diagnose.result import Diagnosis, Trace, View
from usmbench.report.diagnosis_figures import legend, trace_figure, view_figure
from usmbench.report.diagnosis_tables import candidates_table, plan_text, table
from usmbench.report.diagnosis_text import escaped, number, percent, probability_of, times
from usmbench.report.error_text import noise_note, what_is_left

_MOST_TRACES = 6


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
    if diagnosis.causes:
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
    return f'<dl class="figures">{cells}</dl>'


def traces_section(diagnosis: Diagnosis) -> str:
    """Return the runs, measured against simulated.

    Parameters
    ----------
    diagnosis
        What was found.
    """
    extended = bool(diagnosis.causes)
    entries = [("measured", "measured"), ("before", "simulation")]
    if extended:
        entries.append(("after", "simulation with the cause in it"))
    shown = diagnosis.traces[:_MOST_TRACES]
    figures = "".join(_trace(trace, extended=extended) for trace in shown)
    more = len(diagnosis.traces) - len(shown)
    rest = f'<p class="note">{more} more stretches are not drawn.</p>' if more else ""
    thin = ", with the cause in it thin" if extended else ""
    return (
        '<h2 id="runs">Measured against simulated</h2>'
        '<p class="how">Above, the speed; below, what each simulation leaves of it. The '
        "simulation runs free: it is given the commands and never the measured speed. Below, "
        f"the simulation is broad and pale{thin}; what lies beyond the axis is drawn at its "
        "edge.</p>"
        f"{legend(*entries)}{figures}{rest}"
    )


def _trace(trace: Trace, *, extended: bool) -> str:
    figure = trace_figure(trace, extended=extended)
    return f"<figure><figcaption>{escaped(trace.name)}</figcaption>{figure}</figure>"


def views_section(diagnosis: Diagnosis) -> str:
    """Return the residual against each quantity, the farthest out first.

    Parameters
    ----------
    diagnosis
        What was found.
    """
    extended = bool(diagnosis.causes)
    entries = [("band", "band of a run that is as simulated"), ("before marked", "simulation")]
    if extended:
        entries.append(("after marked", "simulation with the cause in it"))
    figures = []
    for view in diagnosis.views:
        beyond = f"{times(view.excess_before)} its band"
        if extended:
            beyond += f", with the cause {times(view.excess_after)}"
        figures.append(
            f"<figure><figcaption><b>Against {escaped(view.versus)}</b>: {beyond}"
            f"{_remark(view)}</figcaption>"
            f"{view_figure(view, extended=extended)}</figure>"
        )
    return (
        '<h2 id="views">What gave it away</h2>'
        '<p class="how">Measured less simulated speed, averaged, without what the simulation '
        "misses on its own runs. Noise, and what healthy runs differ by, keep all points of a "
        "figure within its grey band in 95 of 100 runs; 1 × is at the band's edge. The figure that "
        f'leaves its band farthest comes first.</p>{legend(*entries)}<div class="views">'
        f"{''.join(figures)}</div>"
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
        f"<li>{escaped(name.replace('_', ' '))}: {escaped(why)}</li>"
        for name, why in diagnosis.not_testable
    )
    untested = f"<h3>Not testable with these runs</h3><ul>{refused}</ul>" if refused else ""
    return (
        '<h2 id="evidence">Evidence, cause by cause</h2>'
        '<p class="how">Each cause of the library, fitted alone. Evidence is the drop of the '
        "whitened sum of squares, as far as it speaks for the cause: 0 of 31 where what the model "
        "may be off by explains as much, or where counts should be lost by chance and do not "
        "scatter. p is the probability that the whole library would show as much evidence, with as "
        f"many parameters, where nothing is wrong.</p>{candidates_table(diagnosis)}{untested}"
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
        says = "None is proposed: no causes are left that a sweep would tell apart."
        return f'<h2 id="next">The next experiment</h2><p>{says}</p>'
    odds = ""
    if "odds_before" in proposal:
        before, after = (probability_of(proposal[key]) for key in ("odds_before", "odds_after"))
        odds = (
            f"<p>Odds of telling them apart: <b>{before}</b> with these runs, "
            f"<b>{after}</b> with that sweep, if the simulation is right in all else.</p>"
        )
    return (
        f'<h2 id="next">The next experiment</h2><p>{escaped(proposal["says"])}</p>{odds}'
        "<p>Save this as <code>next.yaml</code> and run <code>usmbench sweep next.yaml --bench "
        f"BENCH.yaml</code>; then diagnose the new run together with these.</p>"
        f"<pre>{plan_text(proposal['plan'])}</pre>"
    )
