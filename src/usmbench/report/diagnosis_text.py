"""A diagnosis in words: the verdict in a sentence."""

import html

from usmbench.diagnose.evidence import NamedCause
from usmbench.diagnose.naming.remainder import LOUD
from usmbench.diagnose.residual.own_gone import GONE
from usmbench.diagnose.result import Diagnosis
from usmbench.report.numbers_text import BLANK, percent, quantity, sized, spelled

HEADLINES = {
    "no_discrepancy": "Nothing wrong was found",
    "explained": "The cause was found",
    "partly_explained": "A cause was found, and something is left",
    "unexplained": "Something is wrong that has no name here",
}
_COUNTS = {2: "Two", 3: "Three"}


def escaped(text: object) -> str:
    """Return text that is safe in HTML and SVG, in content and in quoted attributes.

    Parameters
    ----------
    text
        Anything, most of all what came out of a file. Characters that cannot be seen (controls,
        directional overrides, halves of a surrogate pair) are replaced.
    """
    seen = "".join(
        c if c.isprintable() or c == BLANK else "\N{REPLACEMENT CHARACTER}" for c in str(text)
    )
    return html.escape(seen, quote=True)


def headline(diagnosis: Diagnosis) -> str:
    """Return the verdict in a few words.

    Parameters
    ----------
    diagnosis
        The diagnosis.
    """
    open_sets = [1 + len(cause.alternatives) for cause in diagnosis.causes if cause.alternatives]
    says = HEADLINES[diagnosis.verdict]
    if len(diagnosis.causes) > 1:
        n = _COUNTS.get(len(diagnosis.causes), str(len(diagnosis.causes)))
        says = f"{n} causes were found" + says.partition("was found")[2]
        return says + (", not all told from others" if open_sets else "")
    if diagnosis.verdict == "explained" and open_sets:
        return f"The cause is one of {open_sets[0]}"
    return says


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """Return the verdict in one sentence that a supervisor understands.

    Parameters
    ----------
    diagnosis
        The diagnosis.
    """
    n = f"{diagnosis.n_windows:,}".replace(",", BLANK)
    if diagnosis.verdict == "no_discrepancy":
        if diagnosis.left_over > LOUD:
            return (
                f"Over {n} windows the simulation misses more than on its own runs, and no test "
                "tells that from what may differ between days."
            )
        return (
            f"Over {n} windows the motor does what its simulation says: the error is noise, and "
            "what the simulation misses on its own runs or healthy runs differ by."
        )
    if diagnosis.verdict == "unexplained":
        return (
            f"Over {n} windows the motor departs from its simulation, and none of the "
            f"{len(diagnosis.candidates)} causes that were tried accounts for it: "
            "do not take anything apart on the strength of this page."
        )
    causes = " and ".join(_named(cause) for cause in diagnosis.causes)
    gains = "single windows are struck, and no simulation foresees which"
    if diagnosis.foretells:
        gains = f"knowing this removes {percent(diagnosis.gain)} of the error above the noise"
    left = ", and what is left has no name here" if diagnosis.verdict != "explained" else ""
    return f"The motor departs from its simulation because of {causes}; {gains}{left}."


def _named(cause: NamedCause) -> str:
    """Return a cause with its estimates and what cannot be told from it."""
    sizes = ", ".join(
        f"{quantity(p.name, p.unit)} {sized(p.value, p.unit)}"
        for p in cause.waves or cause.parameters
    )
    gone = " that is gone" if cause.form == GONE else ""
    text = f"{spelled(cause.name)}{gone}" + (f" ({sizes})" if sizes else "")
    if cause.alternatives:
        others = " or ".join(spelled(name) for name in cause.alternatives)
        text = f"either {text} or {others} (these runs cannot tell which)"
    return text
