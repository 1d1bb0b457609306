"""Numbers, shares and sizes with their units, as people write them."""

import math

from usmbench.diagnose.evidence import Estimate

BLANK = "\N{NO-BREAK SPACE}"
_SMALLEST_P = 1e-4
_MOST_DECIMALS = 6
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_NEARLY_ALL = 0.99
_UNITS = {"1": "", "deg": "°"}
# How a name ends in its unit, where it is not the unit as it is written.
_ENDINGS = {
    "rad/s": "_rad_s",
    "s/rad": "_s_per_rad",
    "N·m": "_nm",
    "1/s": "_hz",
    "Hz": "_hz",
    "°C": "_c",
    "%": "_percent",
}
_SMALL = 1e-3  # of a unit: readers see less than that in a smaller one
_SMALLER = {
    "s": (1e6, "µs"),
    "rad": (1e3, "mrad"),
    "rad/s": (1e3, "mrad/s"),
    "N·m": (1e3, "mN·m"),
}


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
        return f"{math.floor(1000.0 * share) / 10.0:.1f}{BLANK}%"
    return f"{100.0 * share:.0f}{BLANK}%".replace("-", "−")


def times(factor: float) -> str:
    """Return a factor with its sign of multiplication, on one line.

    Parameters
    ----------
    factor
        The factor.
    """
    return f"{number(factor, 2)}{BLANK}×"


def probability(p_value: float) -> str:
    """Return a probability; one below any use is given as a bound.

    Parameters
    ----------
    p_value
        The probability.
    """
    return "< 0.0001" if p_value < _SMALLEST_P else number(p_value, 2)


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
    return f"{BLANK}{shown}" if shown else ""


def sized(value: float, unit: str) -> str:
    """Return a number with its unit, a smaller one where it is small; a plain ratio in percent.

    Parameters
    ----------
    value
        The number.
    unit
        Its unit.
    """
    factor, shown = _as_shown(value, unit)
    return number(factor * value) + unit_after(shown)


def with_interval(estimate: Estimate) -> str:
    """Return an estimate with its interval in the unit of `sized`.

    Parameters
    ----------
    estimate
        The estimate.
    """
    factor, shown = _as_shown(estimate.value or estimate.high, estimate.unit)
    unit = unit_after(shown)
    value, low, high = (factor * v for v in (estimate.value, estimate.low, estimate.high))
    if not (math.isfinite(low) and math.isfinite(high)):
        return number(value) + unit
    return f"{_rounded(value, high - low)}{unit} ({_interval(low, high)}{unit})"


def _as_shown(value: float, unit: str) -> tuple[float, str]:
    """Return the factor and the unit in which readers see a quantity of some size."""
    if unit == "1":
        return 100.0, "%"
    return _SMALLER.get(unit, (1.0, unit)) if 0.0 < abs(value) < _SMALL else (1.0, unit)


def _interval(low: float, high: float) -> str:
    return f"{_rounded(low, high - low)} … {_rounded(high, high - low)}"


def _rounded(value: float, width: float) -> str:
    """Return a number to two digits of an interval's width."""
    decimals = 1 - math.floor(math.log10(width)) if width > 0.0 else _MOST_DECIMALS + 1
    if decimals > _MOST_DECIMALS:
        return number(value)
    return f"{value:.{max(decimals, 0)}f}".replace("-", "−")
