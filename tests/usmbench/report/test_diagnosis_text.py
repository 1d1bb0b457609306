"""The verdict in a sentence, and text from files on a page."""

from collections.abc import Callable

from hypothesis import given
from hypothesis import strategies as st

from usmbench.diagnose.result import Diagnosis
from usmbench.report.diagnosis_text import escaped, verdict_sentence


def test_an_error_beyond_that_of_the_own_runs_is_not_called_noise(
    make_diagnosis: Callable[..., Diagnosis],
) -> None:
    healthy = make_diagnosis(verdict="no_discrepancy", causes=())
    assert "the error is noise" in verdict_sentence(healthy)
    far = verdict_sentence(make_diagnosis(verdict="no_discrepancy", causes=(), left_over=2.0))
    assert "more than on its own runs" in far
    assert "is noise" not in far


@given(st.text())
def test_escaped_text_holds_no_markup_and_nothing_unseen(text: str) -> None:
    shown = escaped(text)
    assert not set("<>\"'") & set(shown)
    assert all(c.isprintable() or c == "\N{NO-BREAK SPACE}" for c in shown)
    shown.encode("utf-8")
