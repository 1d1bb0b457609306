"""The verdict in a sentence, and text from files on a page."""

from collections.abc import Callable
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.diagnose.result import Diagnosis
from usmbench.report.diagnosis_text import escaped, headline, verdict_sentence


def test_an_error_beyond_that_of_the_own_runs_is_not_called_noise(
    make_diagnosis: Callable[..., Diagnosis],
) -> None:
    healthy = make_diagnosis(verdict="no_discrepancy", causes=())
    assert "the error is noise" in verdict_sentence(healthy)
    far = verdict_sentence(make_diagnosis(verdict="no_discrepancy", causes=(), left_over=2.0))
    assert "more than on its own runs" in far
    assert "is noise" not in far


@pytest.mark.parametrize(
    ("n", "alternatives", "verdict", "says"),
    [
        (1, (), "explained", "The cause was found"),
        (1, ("a", "b"), "explained", "The cause is one of 3"),
        (2, (), "explained", "Two causes were found"),
        (2, (), "partly_explained", "Two causes were found, and something is left"),
        (2, ("a",), "explained", "Two causes were found, not all told from others"),
    ],
)
def test_the_headline_counts_causes_and_alternatives(
    make_diagnosis: Callable[..., Diagnosis],
    n: int,
    alternatives: tuple[str, ...],
    verdict: str,
    says: str,
) -> None:
    cause = replace(make_diagnosis().causes[0], alternatives=())
    causes = (replace(cause, alternatives=alternatives), cause)[:n]
    assert headline(make_diagnosis(verdict=verdict, causes=causes)) == says


@given(st.text())
def test_escaped_text_holds_no_markup_and_nothing_unseen(text: str) -> None:
    shown = escaped(text)
    assert not set("<>\"'") & set(shown)
    assert all(c.isprintable() or c == "\N{NO-BREAK SPACE}" for c in shown)
    shown.encode("utf-8")
