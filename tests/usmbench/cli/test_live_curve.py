from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.cli.live_curve import BOTH, FALLING, NOW, RISING, LiveCurve
from usmbench.sweep.rows import PairRow


def pair(phase_deg: float, speed_rad_s: float, direction: int, torque_nm: float = 0.0) -> PairRow:
    return PairRow(phase_deg, 41_000.0, torque_nm, speed_rad_s, 0.1, 10, direction, 1.0, 0, 1)


def drawn(*pairs: PairRow, now: tuple[float, float] = (0.0, 0.0)) -> list[str]:
    curve = LiveCurve()
    for one in pairs:
        curve.add(one)
    return curve.lines(60, 15, now)


def test_a_pair_stands_where_its_phase_and_speed_are() -> None:
    lines = drawn(pair(90, 10, 1), pair(-90, -10, -1))
    assert lines[0].endswith(RISING)
    assert lines[0].startswith("     10┤")
    assert lines[12].startswith(f"    -10┤{FALLING}")
    assert lines[6][8 + 26] == NOW
    assert lines[14].split() == ["-90°", "0", "90°"]


def test_rising_and_falling_are_apart_and_a_shared_cell_says_so() -> None:
    lines = "".join(drawn(pair(45, 5, 1), pair(45, 5, -1), pair(60, 7, 1), pair(-60, -7, -1)))
    assert [lines.count(mark) for mark in (RISING, FALLING, BOTH)] == [1, 1, 1]


def test_the_same_dwell_again_replaces_the_point() -> None:
    assert "".join(drawn(pair(80, 9, 1), pair(80, -9, 1))).count(RISING) == 1


def test_another_load_starts_a_new_curve() -> None:
    lines = "".join(drawn(pair(60, 8, 1), pair(90, 9, 1), pair(80, 7, -1, torque_nm=0.1)))
    assert (lines.count(RISING), lines.count(FALLING)) == (0, 1)


@settings(deadline=None, max_examples=40)
@given(
    st.lists(
        st.tuples(st.floats(-180, 180), st.floats(-30, 30), st.sampled_from([1, -1])), max_size=20
    ),
    st.tuples(st.floats(-180, 180), st.floats(-30, 30)),
    st.integers(40, 120),
)
def test_whatever_is_drawn_stays_within_its_room(
    points: list[tuple[float, float, int]], now: tuple[float, float], columns: int
) -> None:
    curve = LiveCurve()
    for point in points:
        curve.add(pair(*point))
    lines = curve.lines(columns, 15, now)
    assert len(lines) == 15
    assert max(map(len, lines)) <= columns
    assert "".join(lines).count(NOW) == 1
