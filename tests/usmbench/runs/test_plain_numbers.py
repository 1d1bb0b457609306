import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.runs import plain_numbers as module
from usmbench.runs.plain_numbers import plain_numbers

FIELD = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False).map(lambda x: f"{x:.12g}"),
    st.integers().map(str),
    st.text(alphabet="01.-+e", max_size=6),
)


def numbers_of(rows: str, n_columns: int) -> list[list[float]] | None:
    found = plain_numbers(rows.encode(), 0, n_columns)
    return None if found is None else found.T.tolist()


@settings(deadline=None, max_examples=300)
@given(st.lists(st.tuples(FIELD, FIELD), min_size=1, max_size=4))
def test_what_is_read_is_what_each_field_says(rows: list[tuple[str, str]]) -> None:
    found = numbers_of("".join(f"{one},{other}\n" for one, other in rows), 2)
    if found is not None:
        assert found == [[float(one), float(other)] for one, other in rows]


@settings(deadline=None, max_examples=100)
@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=1, max_size=9))
def test_all_that_a_sweep_writes_is_plain(values: list[float]) -> None:
    rows = [f"{value:.12g}" for value in values]
    assert numbers_of("\r\n".join(rows), 1) == [[float(text)] for text in rows]


@pytest.mark.parametrize(
    "field",
    ["1-2", "12abc", "1 2", "1.2.3", "1e", "1e-", "1e5e5", "1e-5e5", "1e.5", "1_0", "0x1", "nan",
     "", " ", "-", ".", "1;2", '"1"', "1,2", "1\n2", "\n", "\0"],
)  # fmt: skip
def test_what_is_no_plain_number_is_left_to_the_careful_reader(field: str) -> None:
    assert numbers_of(f"4,{field}\n7,8\n", 2) is None
    assert numbers_of(f"{field},4\n7,8\n", 2) is None


def test_rows_in_several_parts_keep_their_order(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_PART_BYTES", 50)
    table = np.arange(300.0).reshape(100, 3)
    text = "a,b,c\n" + "\n".join(",".join(f"{x:g}" for x in row) for row in table)
    found = plain_numbers(text.encode(), 6, 3)
    assert found is not None
    assert found.T.tolist() == table.tolist()


def test_no_rows_are_no_numbers() -> None:
    found = plain_numbers(b"a,b\n", 4, 2)
    assert found is not None
    assert found.shape == (2, 0)
