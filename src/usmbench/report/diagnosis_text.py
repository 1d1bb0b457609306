"""A diagnosis in words: the verdict in a sentence, numbers as people write them."""

import html
import math

from usmbench.diagnose.evidence import Estimate, NamedCause
from usmbench.diagnose.result import Diagnosis

HEADLINES = {
    "no_discrepancy": "Nothing wrong was found",
    "explained": "The cause was found",
    "partly_explained": "A cause was found, and something is left",
    "unexplained": "Something is wrong that has no name here",
}
_SMALLEST_P = 1e-4
_MOST_DECIMALS = 6
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_NEARLY_ALL = 0.99
_UNITS = {"1": "", "deg": "°"}
# How a name ends in its unit, where it is not the unit as it is written.
_ENDINGS = {"rad/s": "_rad_s", "N·m": "_nm", "1/s": "_hz", "Hz": "_hz", "°C": "_c", "%": "_percent"}
# The only character without ink that a page has a use for beside the plain space.
_BLANK = "\N{NO-BREAK SPACE}"


def escaped(text: object) -> str:
    """Return text that is safe in HTML and SVG, in content and in quoted attributes.

    Parameters
    ----------
    text
        Anything, most of all what came out of a file. Characters that cannot be seen (controls,
        directional overrides, halves of a surrogate pair) are replaced.
    """
    seen = "".join(
        c if c.isprintable() or c == _BLANK else "\N{REPLACEMENT CHARACTER}" for c in str(text)
    )
    return html.escape(seen, quote=True)


def number(value: float | None, digits: int = 3) -> str:
    """Return a number with some significant digits; a dash where there is none.

    Parameters
    ----------
    value
        The number.
    digits
        Significant digits.
    """
    if value is None or not math.isfinite(value):
        return "–"
    text = f"{value:.{digits}g}"
    if "e" in text and 1.0 <= abs(value) < 1e6:
        text = f"{value:.0f}"
    mantissa, _, exponent = text.partition("e")
    mantissa = mantissa.replace("-", "−")
    return f"{mantissa}·10{str(int(exponent)).translate(_RAISED)}" if exponent else mantissa


def percent(share: float) -> str:
    """Return a share in percent; what is not all of it is not rounded to all.

    Parameters
    ----------
    share
        The share; 1 is all of it.
    """
    if not math.isfinite(share):
        return "–"
    if _NEARLY_ALL < share < 1.0:
        return f"{math.floor(1000.0 * share) / 10.0:.1f}{_BLANK}%"
    return f"{100.0 * share:.0f}{_BLANK}%".replace("-", "−")


def times(factor: float) -> str:
    """Return a factor with its sign of multiplication, on one line.

    Parameters
    ----------
    factor
        The factor.
    """
    return f"{number(factor, 2)}{_BLANK}×"


def probability(p_value: float) -> str:
    """Return a probability; one below any use is given as a bound.

    Parameters
    ----------
    p_value
        The probability.
    """
    return "< 0.0001" if p_value < _SMALLEST_P else number(p_value, 2)


def spelled(name: str) -> str:
    """Return a name of a cause as words.

    Parameters
    ----------
    name
        Such as ``transport_delay``.
    """
    return name.replace("_", " ")


def quantity(name: str, unit: str) -> str:
    """Return a parameter's name as words, without its unit.

    Parameters
    ----------
    name
        Such as ``delay_s``.
    unit
        Its unit.
    """
    return spelled(name.removesuffix(_ENDINGS.get(unit, f"_{unit}")))


def unit_after(unit: str) -> str:
    """Return a unit as it follows a number, with its space.

    Parameters
    ----------
    unit
        The unit; "1" is none.
    """
    shown = _UNITS.get(unit, unit)
    if shown == "°":
        return shown
    return f"{_BLANK}{shown}" if shown else ""


def sized(value: float, unit: str) -> str:
    """Return a number with its unit; a plain ratio in percent.

    Parameters
    ----------
    value
        The number.
    unit
        Its unit.
    """
    factor, shown = _as_shown(unit)
    return number(factor * value) + unit_after(shown)


def with_interval(estimate: Estimate) -> str:
    """Return an estimate with its interval and unit; a plain ratio in percent.

    Parameters
    ----------
    estimate
        The estimate.
    """
    factor, shown = _as_shown(estimate.unit)
    unit = unit_after(shown)
    value, low, high = (factor * v for v in (estimate.value, estimate.low, estimate.high))
    if not (math.isfinite(low) and math.isfinite(high)):
        return number(value) + unit
    return f"{_rounded(value, high - low)}{unit} ({_interval(low, high)}{unit})"


def _as_shown(unit: str) -> tuple[float, str]:
    """Return the factor and the unit in which readers see a quantity."""
    return (100.0, "%") if unit == "1" else (1.0, unit)


def _interval(low: float, high: float) -> str:
    return f"{_rounded(low, high - low)} … {_rounded(high, high - low)}"


def _rounded(value: float, width: float) -> str:
    """Return a number to two digits of an interval's width."""
    decimals = 1 - math.floor(math.log10(width)) if width > 0.0 else _MOST_DECIMALS + 1
    if decimals > _MOST_DECIMALS:
        return number(value)
    return f"{value:.{max(decimals, 0)}f}".replace("-", "−")


def headline(diagnosis: Diagnosis) -> str:
    """Return the verdict in a few words.

    Parameters
    ----------
    diagnosis
        The diagnosis.
    """
    open_sets = [1 + len(cause.alternatives) for cause in diagnosis.causes if cause.alternatives]
    if diagnosis.verdict == "explained" and open_sets:
        return f"The cause is one of {open_sets[0]}"
    return HEADLINES[diagnosis.verdict]


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """Return the verdict in one sentence that a supervisor understands.

    Parameters
    ----------
    diagnosis
        The diagnosis.
    """
    n = f"{diagnosis.n_windows:,}".replace(",", _BLANK)
    if diagnosis.verdict == "no_discrepancy":
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
    return (
        f"The motor departs from its simulation because of {causes}; knowing this removes "
        f"{percent(diagnosis.gain)} of the error above the noise"
        + (", and what is left has no name here." if diagnosis.verdict != "explained" else ".")
    )


def _named(cause: NamedCause) -> str:
    """Return a cause with its estimates and what cannot be told from it."""
    sizes = ", ".join(
        f"{quantity(p.name, p.unit)} {sized(p.value, p.unit)}"
        for p in cause.waves or cause.parameters
    )
    text = spelled(cause.name) + (f" ({sizes})" if sizes else "")
    if cause.alternatives:
        others = " or ".join(spelled(name) for name in cause.alternatives)
        text = f"either {text} or {others} (these runs cannot tell which)"
    return text


def probability_of(share: float) -> str:
    """Return the odds of something in percent, never as a certainty.

    Parameters
    ----------
    share
        The probability.
    """
    if share > 0.99:
        return f"more than {percent(0.99)}"
    return f"less than {percent(0.01)}" if share < 0.01 else percent(share)
