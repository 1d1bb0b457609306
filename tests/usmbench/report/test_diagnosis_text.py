"""Text from files on a page."""

from hypothesis import given
from hypothesis import strategies as st

from usmbench.report.diagnosis_text import escaped


@given(st.text())
def test_escaped_text_holds_no_markup_and_nothing_unseen(text: str) -> None:
    shown = escaped(text)
    assert not set("<>\"'") & set(shown)
    assert all(c.isprintable() or c == "\N{NO-BREAK SPACE}" for c in shown)
    shown.encode("utf-8")
