"""Windows that stand alone, and those that only seem to."""

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.noise.noise_model import LAGS, Noise
from usmbench.diagnose.noise.rotor_states import KINDS
from usmbench.diagnose.noise.spikes import are_exceptions, off_steps, spiked
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.runs.record import Record

N, WINDOW_S, NOISE_RAD_S = 400, 0.01, 0.01
CURVE = StaticCurve(np.array([-90.0, 0.0, 90.0]), np.array([-10.0, 0.0, 10.0]))
MODEL = HammersteinModel(
    first_order(0.0035, 0.0015, WINDOW_S),
    (OperatingPoint(None, None, CURVE, (-90.0, 90.0), (None, None), NOISE_RAD_S),),
    "test",
)
NOISE = Noise(
    np.array([-90.0, 90.0]),
    np.full(2, NOISE_RAD_S),
    np.empty(0),
    1.0,
    np.full((LAGS, KINDS, 1), 20.0),
    np.zeros((LAGS, KINDS, 1)),
    np.zeros(4),
    np.zeros(LAGS),
)


@pytest.fixture(scope="module")
def reversing() -> Stretch:
    t_s = WINDOW_S * np.arange(1.0, N + 1.0)
    phase_deg = np.where(np.arange(N) // 20 % 2, 60.0, -60.0)
    record = Record("reversing", t_s, phase_deg, np.zeros(N), np.full(N, WINDOW_S))
    (stretch,), _ = cut_runs([record], MODEL, ())
    return stretch


def _alone(stretch: Stretch, residual_rad_s: NDArray[np.float64]) -> list[int]:
    (far,) = spiked([stretch], [residual_rad_s], NOISE, near_steps=True)
    return np.flatnonzero(far).tolist()


def test_an_error_that_turns_with_the_motion_is_no_spike(reversing: Stretch) -> None:
    residual_rad_s = 0.02 * reversing.settled_rad_s
    assert _alone(reversing, residual_rad_s) == []
    # Nor is the window in which the speed turns.
    residual_rad_s[20::20] *= 0.1
    assert _alone(reversing, residual_rad_s) == []


@pytest.mark.parametrize("windows", [(51,), (51, 52), (59,), (60,)])
def test_false_counts_are_spikes_also_beside_a_reversal(
    reversing: Stretch, windows: tuple[int, ...]
) -> None:
    residual_rad_s = 0.02 * reversing.settled_rad_s
    residual_rad_s[list(windows)] += 1.0
    assert _alone(reversing, residual_rad_s) == list(windows)


@pytest.mark.parametrize("windows", [(80,), (399,), (80, 81, 82)])
def test_what_no_motor_makes_is_no_window_to_judge_wherever_it_stands(
    reversing: Stretch, windows: tuple[int, ...]
) -> None:
    # A delay leaves 2 rad/s in the window of each step.
    residual_rad_s = np.where(reversing.lag == 0, 2.0, 0.0)
    residual_rad_s[list(windows)] = 100.0
    (far,) = spiked([reversing], [residual_rad_s], NOISE, near_steps=False)
    assert np.flatnonzero(far).tolist() == list(windows)
    (far,) = spiked([reversing], [residual_rad_s], NOISE, near_steps=True)
    (alone,) = off_steps([reversing], [residual_rad_s], [far])
    assert np.flatnonzero(alone).tolist() == list(windows)


@pytest.mark.parametrize(("share", "left_out"), [(0.05, True), (0.9, False)])
def test_a_motor_that_turns_where_the_model_stands_is_judged(share: float, left_out: bool) -> None:
    t_s, turns = WINDOW_S * np.arange(1.0, N + 1.0), np.arange(N) >= (1.0 - share) * N
    speed_rad_s = np.where(turns, 5.0, 0.0)
    record = Record("still", t_s, np.zeros(N), speed_rad_s, np.full(N, WINDOW_S))
    (stretch,), _ = cut_runs([record], MODEL, ())
    (far,) = spiked([stretch], [stretch.residual_rad_s], NOISE, near_steps=True)
    assert (np.count_nonzero(far) == np.count_nonzero(turns)) == left_out
    assert left_out or not far.any()


@pytest.mark.parametrize("everywhere_rad_s", [0.0, -1.0])
@pytest.mark.parametrize(("by_chance", "lag"), [(True, 0), (False, 0), (False, -1)])
def test_what_every_step_leaves_is_no_exception(
    reversing: Stretch, by_chance: bool, lag: int, everywhere_rad_s: float
) -> None:
    residual_rad_s = np.random.default_rng(2).normal(everywhere_rad_s, NOISE_RAD_S, N)
    steps = np.array([80, 81, 163, 247] if by_chance else np.arange(20, N, 20))
    struck = steps + lag
    residual_rad_s[struck] -= 20.0 * NOISE_RAD_S * np.sign(reversing.step_rad_s[steps])
    residual_rad_s[250] += 20.0 * NOISE_RAD_S  # far from every step
    (far,) = spiked([reversing], [residual_rad_s], NOISE, near_steps=True)
    assert far[struck].all()
    (alone,) = off_steps([reversing], [residual_rad_s], [far])
    assert np.all(alone[struck] == by_chance)
    assert alone[250]


@pytest.mark.parametrize("everywhere_rad_s", [0.0, -1.0])
@pytest.mark.parametrize(
    ("alike", "share", "chance"),
    [(False, 0.01, True), (True, 0.01, False), (False, 0.2, False)],
)
def test_exceptions_are_few_and_not_off_as_others_at_like_phases(
    alike: bool, share: float, chance: bool, everywhere_rad_s: float
) -> None:
    rng, n = np.random.default_rng(3), 4000
    phase_deg, t_s = rng.uniform(-90.0, 90.0, n), WINDOW_S * np.arange(1.0, n + 1.0)
    record = Record("random", t_s, phase_deg, np.zeros(n), np.full(n, WINDOW_S))
    (stretch,), _ = cut_runs([record], MODEL, ())
    struck = np.argsort(phase_deg)[-int(share * n) :]
    if not alike:
        struck = rng.choice(n, struck.size, replace=False)
    off_rad_s, alone = rng.normal(everywhere_rad_s, NOISE_RAD_S, n), np.zeros(n, dtype=np.bool_)
    off_rad_s[struck] -= 1.0
    alone[struck] = True
    assert are_exceptions([stretch], [off_rad_s], [alone], [stretch.use]) == chance


def test_where_no_row_is_calm_nothing_stands_alone_against_chance(reversing: Stretch) -> None:
    none = np.zeros(N, dtype=bool)
    assert are_exceptions([reversing], [np.zeros(N)], [none], [none])


@pytest.mark.parametrize(("n_struck", "exceptions"), [(4, True), (12, False)])
def test_what_many_steps_leave_to_either_side_is_no_exception(
    reversing: Stretch, n_struck: int, *, exceptions: bool
) -> None:
    rng = np.random.default_rng(4)
    residual_rad_s = rng.normal(0.0, NOISE_RAD_S, N)
    struck = rng.permutation(np.arange(20, N, 20))[:n_struck]
    residual_rad_s[struck] += 20.0 * NOISE_RAD_S * np.resize([1.0, -1.0], n_struck)
    (far,) = spiked([reversing], [residual_rad_s], NOISE, near_steps=True)
    (alone,) = off_steps([reversing], [residual_rad_s], [far])
    assert np.all(alone[struck] == exceptions)
