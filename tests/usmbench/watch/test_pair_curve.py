import numpy as np

from usmbench.watch.pair_curve import PairCurve


def test_rising_and_falling_apart_and_sorted() -> None:
    curve = PairCurve()
    curve.add(np.array([[90.0, 9, 1, 41e3, 0], [45.0, 4, -1, 41e3, 0], [-90.0, -9, 1, 41e3, 0]]))
    columns = curve.columns()
    assert columns["rising"] == {"phase_deg": [-90.0, 90.0], "speed_rad_s": [-9.0, 9.0]}
    assert columns["falling"] == {"phase_deg": [45.0], "speed_rad_s": [4.0]}


def test_another_operating_point_starts_a_new_curve_and_an_unknown_one_does_not() -> None:
    curve = PairCurve()
    curve.add(np.array([[90.0, 9, 1, np.nan, np.nan]]))
    curve.add(np.array([[80.0, 8, 1, np.nan, np.nan]]))
    assert curve.columns()["rising"]["phase_deg"] == [80.0, 90.0]
    curve.add(np.array([[70.0, 7, 1, 42e3, 0.1]]))
    assert curve.columns()["rising"]["phase_deg"] == [70.0]


def test_memory_is_bounded() -> None:
    curve = PairCurve()
    phases_deg = np.random.default_rng(0).uniform(-180, 180, 20_000)
    pairs = np.zeros((20_000, 5))
    pairs[:, 0], pairs[:, 2] = phases_deg, 1.0
    curve.add(pairs)
    assert len(curve.columns()["rising"]["phase_deg"]) <= 1441
