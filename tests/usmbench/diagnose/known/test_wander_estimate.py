"""How far runs wander, from what they show: no more than they rule out, no less than they leave."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import chi2
from scipy.stats import t as student

from usmbench.diagnose.known.wander import Wander, wander_of_deviations
from usmbench.diagnose.known.wander_estimate import beside, measured_wander

Array = NDArray[np.float64]
WIDEST = Wander(
    0.01, (1e-3, 2e-3), 1e-4, 0.02, 0.05, 0.01, 0.01, (0.1, 0.2), 0.01, 0.1, 0.05, 1e-4, 0.1, 5
)
LEAST = Wander(
    3e-4, (5e-5, 5e-5), 3e-6, 1e-3, 1e-3, 3e-4, 3e-4, (1e-3, 1e-3), 1e-3, 0.01, 1e-3, 1e-5, 0.1, 5
)
N = WIDEST.deviations.size
DAY = np.r_[
    1.0, 0.2, 0.5, 0.1, 0.0, 0.3, 0.6, 0.4, 0.4, 2.0, 0.5, np.repeat([0.4, 0.1, 0.3, 0.5], 5), 0.5
]
RUNS = np.array([DAY, -DAY])


def _equations(runs: Array, precision: Array) -> tuple[Array, Array]:
    """Return the normal equations of departures that each run shows by itself."""
    gram = np.einsum("rs,vw->rvsw", np.eye(len(runs)), precision)
    return gram, runs @ precision


def test_the_wander_is_the_spread_of_the_runs_and_what_their_number_leaves_open() -> None:
    runs = 0.3 * np.concatenate([RUNS, RUNS]) * WIDEST.deviations
    found = measured_wander(WIDEST, LEAST, *_equations(runs, 1e14 * np.eye(N)))
    # Four values, three of them free.
    spread = 0.3 * 2.0 / np.sqrt(chi2.ppf(0.3, 3))
    assert found.gain == pytest.approx(0.01 * spread, rel=0.05)
    assert found.gain_tilt[1] == pytest.approx(1e-3 * spread, rel=0.05)
    assert found.wider == pytest.approx(0.05 * 0.6 * spread, rel=0.05)
    assert found.one_sided == pytest.approx(0.01 * 0.4 * spread, rel=0.05)
    assert found.one_sided_ends == pytest.approx(0.01 * 0.4 * spread, rel=0.05)
    assert found.held_back_rad_s == pytest.approx((0.2 * spread, 0.1 * spread), rel=0.05)


@pytest.mark.parametrize(("n_runs", "least"), [(2, 0.02), (3, 0.02), (6, 0.0)])
def test_a_gain_of_few_runs_passes_for_a_cause_on_one_day_in_forty(
    n_runs: int, least: float
) -> None:
    """Beyond three deviations: by Student's t, of the spread of so many runs."""
    apart = np.linspace(-1.0, 1.0, n_runs)[:, None] * DAY
    runs = 0.03 * apart * WIDEST.deviations
    found = measured_wander(WIDEST, LEAST, *_equations(runs, 1e14 * np.eye(N)))
    spread = float(np.std(runs[:, 0], ddof=1))
    beyond = 2.0 * student.sf(3.0 * found.gain / spread, n_runs - 1)
    assert least < beyond < 0.03


def test_departures_that_no_run_can_show_stay_at_the_least() -> None:
    runs = np.concatenate([RUNS, RUNS]) * WIDEST.deviations
    blind = np.eye(N)
    blind[0, 0] = 0.0
    found = measured_wander(WIDEST, LEAST, *_equations(runs, 1e14 * blind))
    assert found.gain == LEAST.gain


@pytest.mark.parametrize("common", [0.3, 6.0])
@pytest.mark.parametrize("blind", [False, True])
def test_what_runs_have_in_common_is_no_wander_where_one_shows_nothing_of_it(
    common: float, blind: bool
) -> None:
    apart = 0.01 * np.random.default_rng(6).standard_normal((6, N))
    gram, slope = _equations((common + apart) * WIDEST.deviations, 1e14 * np.eye(N))
    if blind:
        gram[-1], slope[-1] = 0.0, 0.0
    found = measured_wander(WIDEST, LEAST, gram, slope)
    assert found.gain < 0.03 * WIDEST.gain
    assert found.stuck_rad_s < 0.08 * WIDEST.stuck_rad_s  # the least is 0.05


@pytest.mark.parametrize("alike", [0.0, 0.99])
def test_departures_that_look_alike_wander_by_no_more_than_they_do_together(alike: float) -> None:
    # Apart, gain and tilt are seven times as unsure as what they do together.
    precision = np.diag(400.0 / WIDEST.deviations**2)
    precision[0, 1] = precision[1, 0] = alike * np.sqrt(precision[0, 0] * precision[1, 1])
    together = []
    for seed in range(20):
        noise = np.random.default_rng(seed)
        runs = noise.multivariate_normal(np.zeros(N), np.linalg.inv(precision), 4)
        found = measured_wander(WIDEST, LEAST, *_equations(runs, precision))
        shares = found.gain / WIDEST.gain, found.gain_tilt[0] / WIDEST.gain_tilt[0]
        together.append(np.hypot(*shares))
    assert np.median(together) < 0.15


def test_one_run_shows_no_wander() -> None:
    assert measured_wander(WIDEST, LEAST, np.zeros((1, N, 1, N)), np.zeros((1, N))) == LEAST


def test_all_thermal_time_constants_have_one_deviation() -> None:
    drawn = np.random.default_rng(3).standard_normal((12, N))
    found = measured_wander(WIDEST, LEAST, *_equations(drawn * WIDEST.deviations, 1e9 * np.eye(N)))
    # Fifty-five values, so that little is left open.
    assert found.warms_gain == pytest.approx(WIDEST.warms_gain, rel=0.2)
    assert found.warms_shift == pytest.approx(WIDEST.warms_shift, rel=0.2)
    assert wander_of_deviations(found.deviations, LEAST) == found


def test_what_is_learnt_beside_leaves_the_same_solution() -> None:
    columns = np.random.default_rng(4).standard_normal((30, 6))
    gram, slope = columns.T @ columns, columns.T @ np.random.default_rng(5).standard_normal(30)
    own = np.array([False, True, False, True, True, False])
    left, toward = beside(gram, slope, own)
    np.testing.assert_allclose(
        np.linalg.solve(left, toward), np.linalg.solve(gram, slope)[own], rtol=1e-9
    )
