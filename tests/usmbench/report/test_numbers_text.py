"""Numbers, units and names as people write them."""

import math

import pytest

from usmbench.diagnose.evidence import Estimate
from usmbench.report.numbers_text import (
    number,
    percent,
    probability,
    probability_of,
    quantity,
    sized,
    with_interval,
)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1234.0, "1234"),
        (-0.0123, "−0.0123"),
        (1.5e-7, "1.5·10⁻⁷"),
        (2.5e9, "2.5·10⁹"),
        (None, "–"),
        (math.nan, "–"),
        (-math.inf, "–"),
    ],
)
def test_a_number(value: float | None, text: str) -> None:
    assert number(value) == text


@pytest.mark.parametrize(
    ("estimate", "text"),
    [
        (Estimate("delay_s", 0.00533, 0.0046, 0.00605, "s"), "0.0053 s (0.0046 … 0.0060 s)"),
        (Estimate("offset_deg", -3.14, -3.5, -2.8, "deg"), "−3.14° (−3.50 … −2.80°)"),
        (Estimate("scale_error", 0.0273, 0.024, 0.029, "1"), "2.73 % (2.40 … 2.90 %)"),
        (Estimate("warm_up_s", 1234.0, 800.0, 2500.0, "s"), "1234 s (800 … 2500 s)"),
        (Estimate("step_deg", 5.625, 5.625, 5.625, "deg"), "5.62° (5.62 … 5.62°)"),
        (Estimate("gap_rad", 0.1, 0.0, math.inf, "rad"), "0.1 rad"),
        (Estimate("gap_rad", 4.69e-4, 3e-4, 1.2e-3, "rad"), "0.47 mrad (0.30 … 1.20 mrad)"),
        (Estimate("delay_s", 9.6e-5, -1e-5, 2e-4, "s"), "96 µs (−10 … 200 µs)"),
        (Estimate("delay_s", 0.0, -1e-4, 1e-4, "s"), "0 µs (−100 … 100 µs)"),
    ],
)
def test_an_estimate_has_the_digits_of_its_interval(estimate: Estimate, text: str) -> None:
    assert with_interval(estimate).replace("\N{NO-BREAK SPACE}", " ") == text


@pytest.mark.parametrize(
    ("name", "unit", "text"),
    [
        ("delay_s", "s", "delay"),
        ("rate_hz", "1/s", "rate"),
        ("drag_rad_s", "rad/s", "drag"),
        ("drift_by_turning_s_per_rad", "s/rad", "drift by turning"),
        ("one_sided", "1", "one sided"),
    ],
)
def test_a_quantity_is_named_without_its_unit(name: str, unit: str, text: str) -> None:
    assert quantity(name, unit) == text


def test_shares_and_probabilities() -> None:
    assert percent(0.854) == "85\N{NO-BREAK SPACE}%"
    assert percent(0.9951) == "99.5\N{NO-BREAK SPACE}%"
    assert percent(0.99999) == "99.9\N{NO-BREAK SPACE}%"
    assert percent(1.0) == "100\N{NO-BREAK SPACE}%"
    assert percent(math.nan) == "–"
    assert probability(1e-9) == "< 0.0001"
    assert probability(0.034) == "0.034"
    odds = [probability_of(p).replace("\N{NO-BREAK SPACE}", " ") for p in (0.9999, 0.6, 1e-9)]
    assert odds == ["more than 99 %", "60 %", "less than 1 %"]
    assert sized(0.05, "1") == "5\N{NO-BREAK SPACE}%"


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (1.18e-4, "s", "118 µs"),
        (1e-3, "s", "0.001 s"),
        (-4.69e-4, "rad", "−0.469 mrad"),
        (2.5e-4, "rad/s", "0.25 mrad/s"),
        (2.5e-4, "N·m", "0.25 mN·m"),
        (2.5e-4, "1", "0.025 %"),
        (2.5e-4, "deg", "0.00025°"),
    ],
)
def test_what_is_small_has_a_small_unit(value: float, unit: str, text: str) -> None:
    assert sized(value, unit).replace("\N{NO-BREAK SPACE}", " ") == text
