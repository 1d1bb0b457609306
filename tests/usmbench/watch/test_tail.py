from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.errors import InputError
from usmbench.watch import tail
from usmbench.watch.tail import RowTail

HEAD = "t_s,phase_deg,speed_rad_s\n"


def append(path: Path, text: str) -> None:
    with path.open("a", encoding="utf-8") as file:
        file.write(text)


def test_only_what_has_come_since_and_only_whole_rows(tmp_path: Path) -> None:
    path = tmp_path / "windows.csv"
    rows = RowTail(path, ("phase_deg", "torque_nm", "t_s"))
    assert rows.look().shape == (0, 3)
    append(path, HEAD[:5])
    assert rows.look().shape == (0, 3)
    append(path, HEAD[5:] + "0.01,90,9\n0.0")
    np.testing.assert_array_equal(rows.look(), [[90.0, np.nan, 0.01]])
    append(path, "2,45,4\n0.03,30,3\n")
    np.testing.assert_array_equal(rows.look()[:, 2], [0.02, 0.03])
    assert rows.look().shape == (0, 3)


def test_a_row_that_holds_no_numbers_is_passed_over_and_counted(tmp_path: Path) -> None:
    path = tmp_path / "windows.csv"
    append(path, HEAD + "0.01,90,9\n0.02,oops,9\n0.03\n0.04,80,8\n")
    rows = RowTail(path, ("t_s", "phase_deg"))
    np.testing.assert_array_equal(rows.look(), [[0.01, 90.0], [0.04, 80.0]])
    assert rows.unreadable_rows == 2


def test_text_in_other_columns_does_not_matter(tmp_path: Path) -> None:
    path = tmp_path / "windows.csv"
    append(path, "remark,t_s\nwarm,0.01\n")
    np.testing.assert_array_equal(RowTail(path, ("t_s",)).look(), [[0.01]])


def test_a_needed_column_that_is_missing_is_named(tmp_path: Path) -> None:
    path = tmp_path / "windows.csv"
    append(path, "t_s\n")
    with pytest.raises(InputError, match=r"windows\.csv:1: no column 'phase_deg'"):
        RowTail(path, ("t_s",), ("phase_deg",)).look()


def test_a_file_that_is_none_is_said(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        RowTail(tmp_path, ("t_s",)).look()


@settings(deadline=None, max_examples=30)
@given(
    st.lists(st.floats(-1e6, 1e6), max_size=30),
    st.lists(st.integers(1, 40), min_size=1, max_size=30),
    st.integers(1, 64),
)
def test_however_the_bytes_come_the_rows_are_the_same(
    tmp_path_factory: pytest.TempPathFactory, values: list[float], cuts: list[int], chunk: int
) -> None:
    path = tmp_path_factory.mktemp("tail") / "windows.csv"
    data = ("t_s\n" + "".join(f"{value!r}\n" for value in values)).encode()
    rows, seen = RowTail(path, ("t_s",)), []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tail, "CHUNK_BYTES", chunk)
        for cut in [*cuts, len(data)]:
            with path.open("ab") as file:
                file.write(data[:cut])
            data = data[cut:]
            for _ in range(path.stat().st_size // chunk + 2):
                seen += rows.look()[:, 0].tolist()
    assert seen == values
