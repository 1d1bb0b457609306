"""The report's cards: what is known of each named cause."""

from usmbench.diagnose.evidence import NamedCause
from usmbench.diagnose.result import Diagnosis
from usmbench.report.diagnosis_tables import table
from usmbench.report.diagnosis_text import escaped
from usmbench.report.numbers_text import percent, probability, quantity, spelled, with_interval


def causes_section(diagnosis: Diagnosis) -> str:
    """Return what is known of each named cause.

    Parameters
    ----------
    diagnosis
        The diagnosis.
    """
    if not diagnosis.causes:
        return ""
    beside = ""
    if len(diagnosis.causes) > 1:
        beside = (
            '<p class="how">p of a cause that was found after another is beside that one; in the '
            "table above each is alone.</p>"
        )
    cards = "".join(_card(cause) for cause in diagnosis.causes)
    return f'<h2 id="causes">What it is, and how large</h2>{beside}{cards}'


def _card(cause: NamedCause) -> str:
    """One cause."""
    rows = [
        (
            "",
            (
                f'{escaped(quantity(p.name, p.unit))} <span class="how">{escaped(p.what)}</span>',
                escaped(with_interval(p)),
                "–" if p in cause.waves else f"<code>{escaped(p.name)}: {p.value:.6g}</code>",
            ),
        )
        for p in (*cause.waves, *cause.parameters)
    ]
    sizes = table(("Parameter", "Value (95 % interval)", "In the model file"), rows) if rows else ""
    others = ", ".join(spelled(name) for name in cause.alternatives)
    tied = f"<p><b>These runs cannot tell it from:</b> {escaped(others)}.</p>" if others else ""
    form = f' <span class="how">({escaped(cause.form)})</span>' if cause.form else ""
    return (
        f'<div class="cause"><h3>{escaped(spelled(cause.name))}{form}</h3>'
        f"<p>{escaped(cause.meaning)}</p><p><b>On the bench:</b> {escaped(cause.mend)}</p>"
        f"{tied}{sizes}<p>p {escaped(probability(cause.p_value))}; {_gain(cause)}.</p></div>"
    )


def _gain(cause: NamedCause) -> str:
    """Say what it is worth to know the cause."""
    if cause.single:
        return "no simulation foresees which windows it strikes: to know it removes no error"
    return f"it removes {percent(cause.gain)} of the held-out error above the noise"
