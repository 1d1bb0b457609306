"""What no command can take is refused by the row."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.errors import InputError
from usmbench.runs.check_record import changed_since_closed, check_numbers, check_together
from usmbench.runs.record import Record

T_S = 0.01 * np.arange(1.0, 6.0)
RECORD = Record("a run", T_S, np.zeros(5), np.ones(5), np.full(5, 0.01))


def test_numbers_are_taken() -> None:
    check_numbers(RECORD)
    check_numbers(replace(RECORD, torque_nm=np.zeros(5)))


@pytest.mark.parametrize(
    "column", ["t_s", "phase_deg", "speed_rad_s", "frequency_hz", "torque_nm", "angle_rad"]
)
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_no_number_is_refused_by_its_row(column: str, value: float) -> None:
    values = np.r_[1.0, 2.0, value, 4.0, 5.0]
    with pytest.raises(InputError, match=rf"^a run: {column} of row 2 is {value}; remove the row"):
        check_numbers(replace(RECORD, **{column: values}))


def test_a_run_without_a_row_is_refused() -> None:
    none = np.empty(0)
    with pytest.raises(InputError, match="there is no row"):
        check_numbers(Record("a run", none, none, none, none))


def test_a_time_before_the_first_sample_is_refused() -> None:
    with pytest.raises(InputError, match=r"a run: t_s begins at -5\.99 s; count it from the first"):
        check_numbers(replace(RECORD, t_s=T_S - 6.0))


def test_a_number_beyond_all_measuring_is_refused() -> None:
    with pytest.raises(InputError, match="speed_rad_s of row 2 is 1e"):
        check_numbers(replace(RECORD, speed_rad_s=np.r_[1.0, 2.0, 1e300, 4.0, 5.0]))


def test_a_run_that_is_given_twice_is_refused() -> None:
    first, other = (replace(RECORD, name=n, meta={"id": n}) for n in ("a", "b"))
    check_together([first, other])
    for again in (first, replace(first, name="copy", speed_rad_s=np.zeros(5))):
        with pytest.raises(InputError, match=f"{again.name}: is the same run as a; give each run"):
            check_together([first, other, again])


def test_runs_of_two_motors_or_two_encoders_are_refused() -> None:
    def said(name: str, motor: str | None, counts: int | None) -> Record:
        meta = {"id": name, "motor": motor, "encoder": {"counts_per_rev": counts}}
        return replace(RECORD, name=name, meta=meta)

    first, unsaid = said("a", "round one", 2000), said("b", None, None)
    check_together([first, unsaid, said("c", "round one", 2000)])
    with pytest.raises(InputError, match=r"a is of round one; d is of flat one; take one motor"):
        check_together([first, unsaid, said("d", "flat one", 2000)])
    with pytest.raises(InputError, match=r"a has 2000 counts .*; d has 4096 counts .* one encoder"):
        check_together([first, unsaid, said("d", "round one", 4096)])


def test_a_run_without_an_id_is_known_by_its_rows() -> None:
    """A bare CSV given twice, or beside the run folder that it lies in."""
    folder = replace(RECORD, name="folder", meta={"id": "a"})
    turned = replace(RECORD, name="other", speed_rad_s=2.0 * RECORD.speed_rad_s)
    check_together([RECORD, turned, replace(RECORD, name="loaded", torque_nm=np.ones(5))])
    for pair in ([RECORD, turned, RECORD], [folder, RECORD], [RECORD, folder]):
        with pytest.raises(InputError, match=f"{pair[-1].name}: is the same run as"):
            check_together(pair)


def test_data_that_changed_after_the_run_was_closed_are_told() -> None:
    assert changed_since_closed([RECORD]) == []
    changed = replace(RECORD, changed=("windows.csv", "pairs.csv"))
    (said,) = changed_since_closed([RECORD, changed])
    assert said.startswith("a run: windows.csv and pairs.csv changed after the run was closed")
