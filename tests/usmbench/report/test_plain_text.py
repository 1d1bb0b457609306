"""Text of others, where it is shown and where it names files."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.report.plain_text import file_name


@pytest.mark.parametrize(
    ("name", "kept"),
    [
        ("phase-sweep", "phase-sweep"),
        ("../../evil", "_.._evil"),
        ("a b/c", "a_b_c"),
        ("\x1b[31mred", "__31mred"),
        ("", "unnamed"),
        ("größe 2", "größe_2"),
    ],
)
def test_a_plan_names_a_folder(name: str, kept: str) -> None:
    assert file_name(name) == kept


@given(st.text())
def test_whatever_a_plan_is_called_its_folder_stays_where_it_belongs(name: str) -> None:
    path = Path("runs") / f"today-{file_name(name)}"
    assert path.parent == Path("runs")
    assert path.name.isprintable()
