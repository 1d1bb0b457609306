"""What ``usmbench diagnose`` says of a diagnosis on a terminal."""

import textwrap
from collections.abc import Iterator

from usmbench.diagnose.evidence import Estimate, NamedCause
from usmbench.diagnose.result import Diagnosis
from usmbench.report.experiment_text import odds_of, why_no_experiment
from usmbench.report.numbers_text import BLANK, quantity, sized, with_interval

_LABEL = 11  # letters
_WIDTH = 100


def diagnosis_lines(found: Diagnosis) -> str:
    """Return what was found, as lines of a label and what it is.

    Parameters
    ----------
    found
        The diagnosis.
    """
    lines = [_line("verdict", found.verdict)]
    for cause in found.causes:
        lines += _cause(cause)
    lines.append(
        _line(
            "RMSE",
            f"{found.rmse_simulation_rad_s:.4g} rad/s, extended {found.rmse_extended_rad_s:.4g}, "
            f"noise {found.noise_floor_rad_s:.4g} (held out)",
        )
    )
    if found.foretells:
        gain = f"{found.gain:.3f} ({found.gain_low:.3f} … {found.gain_high:.3f})"
        lines.append(_line("gain", gain))
    if found.remainder is not None:
        lines.append(_line("remainder", found.remainder.says))
    lines += _next(found)
    lines += [_line("not tested", f"{name}: {reason}") for name, reason in found.not_testable]
    if found.verdict == "no_discrepancy":
        lines += _would_show(found)
    return "\n".join(lines).replace(BLANK, " ")


def _line(label: str, text: str) -> str:
    """Return a line under its label, or under the one before."""
    return f"{label:{_LABEL}}{text}"


def _cause(cause: NamedCause) -> Iterator[str]:
    """Yield what is known of a cause."""
    form = f" ({cause.form})" if cause.form else ""
    sizes = ", ".join(map(_estimate, cause.parameters))
    yield _line("cause", f"{cause.name}{form}{': ' + sizes if sizes else ''}")
    yield _line("", cause.meaning)
    yield _line("", cause.mend)
    yield from (_line("", f"{p.name}: {p.what}") for p in cause.parameters if p.what)
    yield from (_line("", f"{_estimate(p)}: {p.what}") for p in cause.waves)
    if cause.alternatives:
        yield _line("", f"cannot be told from {', '.join(cause.alternatives)}")


def _estimate(estimate: Estimate) -> str:
    return f"{quantity(estimate.name, estimate.unit)} {with_interval(estimate)}"


def _next(found: Diagnosis) -> Iterator[str]:
    """Yield the next experiment, or why causes stay open without one."""
    proposal = found.next_experiment
    if proposal is None:
        if any(cause.alternatives for cause in found.causes):
            yield _line("next", why_no_experiment(found))
        return
    yield _line("next", proposal["says"])
    odds = odds_of(proposal)
    if odds is not None:
        yield _line("", f"odds of telling them apart: {odds[0]}, then {odds[1]}")


def _would_show(found: Diagnosis) -> list[str]:
    """Return the smallest sizes that these runs would have shown, in a few lines."""
    # A size stays on one line, and with its cause.
    sizes = ", ".join(
        f"{d.cause} {sized(d.value, d.unit)}".replace(" ", BLANK) for d in found.minimum_detectable
    )
    text = f"(in 9 of 10 cases) {sizes}" if sizes else "nothing within its bounds"
    lines = textwrap.wrap(text, _WIDTH - _LABEL, break_long_words=False, break_on_hyphens=False)
    return [_line("" if k else "would show", line) for k, line in enumerate(lines)]
