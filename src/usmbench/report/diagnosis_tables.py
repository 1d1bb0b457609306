"""The report's tables and lists."""

from collections.abc import Mapping, Sequence
from typing import Any

import yaml

from usmbench import __version__
from usmbench.diagnose.evidence import Candidate
from usmbench.diagnose.result import Diagnosis
from usmbench.model.hammerstein import HammersteinModel
from usmbench.report.diagnosis_text import escaped
from usmbench.report.numbers_text import number, percent, probability, quantity, sized, spelled
from usmbench.runs.columns import DRIVE_COLUMN
from usmbench.runs.record import Record

_EVIDENCE = ("Cause", "#Evidence", "#Parameters", "#p", "Share it explains", "Fitted alone")
_TELLING_P = 0.05
_TAGS = {
    "named": ' <span class="tag named">named</span>',
    "tied": ' <span class="tag tied">cannot be told apart</span>',
    "": "",
}


def table(columns: Sequence[str], rows: Sequence[tuple[str, Sequence[str]]]) -> str:
    """Return a table; on a narrow page each row becomes a small block.

    Parameters
    ----------
    columns
        Headings, plain text; one that starts with ``#`` is a column of figures.
    rows
        (class in the style sheet, cells as HTML) of each row.
    """
    styles = [' class="figure"' if c.startswith("#") else "" for c in columns]
    names = [escaped(c.removeprefix("#")) for c in columns]
    heads = "".join(f"<th{s}>{n}</th>" for s, n in zip(styles, names, strict=True))
    body = ""
    for kind, cells in rows:
        inner = "".join(
            f'<td{style} data-label="{name}"><span>{cell}</span></td>'
            for style, name, cell in zip(styles, names, cells, strict=True)
        )
        body += f'<tr class="{kind}">{inner}</tr>' if kind else f"<tr>{inner}</tr>"
    return f"<table><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>"


def candidates_table(diagnosis: Diagnosis) -> str:
    """Return the evidence for every cause.

    Parameters
    ----------
    diagnosis
        The diagnosis.
    """
    named = {cause.name for cause in diagnosis.causes}
    tied = {name for cause in diagnosis.causes for name in cause.alternatives} - named
    shown: list[tuple[str, tuple[str, ...]]] = []
    folded: list[tuple[str, tuple[str, ...]]] = []
    for candidate in diagnosis.candidates:
        kind = "named" if candidate.name in named else "tied" if candidate.name in tied else ""
        row = (kind, _candidate_cells(candidate, _TAGS[kind]))
        (shown if kind or candidate.p_value < _TELLING_P else folded).append(row)
    rest = f"<details><summary>{_counted(len(folded))} without evidence</summary>"
    return (table(_EVIDENCE, shown) if shown else "") + (
        f"{rest}{table(_EVIDENCE, folded)}</details>" if folded else ""
    )


def _counted(n: int) -> str:
    return f"{n} cause{'' if n == 1 else 's'}"


def _candidate_cells(candidate: Candidate, tag: str) -> tuple[str, ...]:
    """Cells of one cause's row."""
    form = f' <span class="how">{escaped(candidate.form)}</span>' if candidate.form else ""
    share = candidate.explained
    sizes = ", ".join(
        f"{escaped(quantity(p.name, p.unit))} {escaped(sized(p.value, p.unit))}"
        for p in candidate.parameters
    )
    return (
        f"{escaped(spelled(candidate.name))}{form}{tag}",
        _evidence_cell(candidate),
        str(candidate.n_parameters),
        escaped(probability(candidate.p_value)),
        f'<span class="bar"><i style="width:{100.0 * share:.0f}%"></i></span>{percent(share)}',
        f'<span class="how">{sizes}</span>',
    )


def _evidence_cell(candidate: Candidate) -> str:
    """Evidence that counts for a cause, and of how much."""
    counts = number(max(candidate.statistic - candidate.misfit, 0.0))
    if not candidate.misfit:
        return counts
    return f'{counts} <span class="how">of {number(candidate.statistic)}</span>'


def detectable_table(diagnosis: Diagnosis) -> str:
    """Return the smallest sizes that these runs would have shown.

    Parameters
    ----------
    diagnosis
        The diagnosis.
    """
    rows = [
        (
            "",
            (
                escaped(spelled(d.cause)),
                escaped(quantity(d.parameter, d.unit)),
                escaped(sized(d.value, d.unit)),
            ),
        )
        for d in diagnosis.minimum_detectable
    ]
    return (
        '<h2 id="detectable">What would have been seen</h2>'
        '<p class="how">The smallest size of each cause that runs like these show in 9 of 10 '
        f"cases.</p>{table(('Cause', 'Parameter', '#Smallest size'), rows)}"
    )


def runs_table(records: Sequence[Record]) -> str:
    """Return the runs that were diagnosed.

    Parameters
    ----------
    records
        The runs.
    """
    rows = []
    for record in records:
        # Where the drive was off is looked at: such runs are refused.
        others = ", ".join(name for name in record.extra if name != DRIVE_COLUMN) or "–"
        rows.append(
            (
                "",
                (
                    escaped(record.name),
                    escaped(record.meta.get("id", "–")),
                    escaped(record.meta.get("started", "–")),
                    str(record.t_s.size),
                    f"{number(float(record.window_s.sum()))} s",
                    escaped(others),
                ),
            )
        )
    columns = ("Run", "Id", "Started", "#Windows", "#Duration", "Columns not used")
    return table(columns, rows)


def fitted_on(model: HammersteinModel) -> str:
    """Return what the model is and which runs it was identified on.

    Parameters
    ----------
    model
        The model.
    """
    runs = "".join(f"<li>{_listed(entry)}</li>" for entry in model.fitted_on)
    known = ", ".join(spelled(str(effect.get("name", "?"))) for effect in model.effects)
    carried = f"<p>Causes already in it: {escaped(known)}.</p>" if known else ""
    source = f"<p>It was identified on:</p><ul>{runs}</ul>" if runs else ""
    return (
        f"<p>The model: method {escaped(model.method)}, "
        f"{len(model.points)} operating point{'s' if len(model.points) > 1 else ''}. The causes "
        f"were fitted on the runs above, the model itself stayed as it is.</p>{carried}{source}"
    )


def files_table(sums: Mapping[str, str]) -> str:
    """Return the files that were read, with their sums, and the program that read them.

    Parameters
    ----------
    sums
        SHA-256 of every file, by its name.
    """
    rows = [
        ("", (f"<code>{escaped(name)}</code>", f"<code>{escaped(value)}</code>"))
        for name, value in sums.items()
    ]
    return (
        f"<h3>Files</h3>{table(('File', 'SHA-256'), rows)}"
        f'<p class="note">Written by usmbench {escaped(__version__)}.</p>'
    )


def _listed(entry: dict[str, Any]) -> str:
    """One entry of the model's provenance."""
    return ", ".join(f"{escaped(key)} {escaped(value)}" for key, value in entry.items())


def plan_text(plan: dict[str, Any]) -> str:
    """Return a plan as its YAML file, escaped.

    Parameters
    ----------
    plan
        The plan's document.
    """
    text = yaml.safe_dump(
        plan, sort_keys=False, allow_unicode=True, default_flow_style=None, width=88
    )
    return "\n".join(escaped(line) for line in text.splitlines())
