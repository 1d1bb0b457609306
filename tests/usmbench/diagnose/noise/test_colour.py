"""What a fit takes from the colour of its residual is given back."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.linalg import toeplitz
from scipy.signal import lfilter

from known_motor import measured
from usmbench.diagnose.noise import noise_estimate
from usmbench.diagnose.noise.colour import autocovariance, taken_by_fit
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.noise import autoregression

Array = NDArray[np.float64]

LAGS = 7


def _autocovariance(rows: Array) -> Array:
    n = rows.size
    return np.array([rows[k:] @ rows[: n - k] / (n - k) for k in range(LAGS)])


def _slow(covariance: Array, n: int) -> float:
    """Standard deviation of the noise's slowest part, in that of a white one's."""
    ar, innovation = autoregression(covariance, n)
    return innovation / float(1.0 - ar.sum())


def _of_staircases(colour: float, windows_a_level: int, seed: int) -> tuple[float, float]:
    """Return the slow part that fits of levels leave, and with what they took, over the noise's."""
    # One staircase of 4 windows a level is too short to show that its noise has any colour.
    stairs = [np.r_[np.arange(20), np.arange(20)[::-1]] + 20 * k for k in range(3)]
    levels = np.repeat(np.concatenate(stairs), windows_a_level)
    basis, n = np.eye(60)[levels], levels.size
    rng = np.random.default_rng(seed)
    whole, bare, mended = [], [], []
    for _ in range(15):
        noise = lfilter([1.0], [1.0, -colour], rng.standard_normal(n + 50))[50:]
        left = noise - basis @ np.linalg.lstsq(basis, noise, rcond=None)[0]
        whole.append(_slow(_autocovariance(noise), n))
        covariance = _autocovariance(left)
        bare.append(_slow(covariance, n))
        mended.append(_slow(covariance + taken_by_fit([1e3 * basis], covariance, n), n))
    return float(np.median(bare) / np.median(whole)), float(np.median(mended) / np.median(whole))


@given(
    colour=st.floats(-0.3, 0.8),
    windows_a_level=st.integers(4, 30),
    seed=st.integers(0, 1000),
)
@settings(max_examples=3, deadline=None)
def test_the_noise_of_a_staircase_is_what_it_was_before_its_levels_were_fitted(
    colour: float, windows_a_level: int, seed: int
) -> None:
    _, mended = _of_staircases(colour, windows_a_level, seed)
    assert mended == pytest.approx(1.0, abs=0.2)


@pytest.mark.parametrize(("colour", "windows_a_level"), [(0.3, 6), (0.6, 12), (0.8, 20)])
def test_without_it_the_noise_looks_calmer(colour: float, windows_a_level: int) -> None:
    bare, mended = _of_staircases(colour, windows_a_level, 0)
    assert bare < 0.9
    assert mended == pytest.approx(1.0, abs=0.05)


def test_a_ridge_takes_what_its_hat_matrix_says() -> None:
    rng = np.random.default_rng(3)
    columns = rng.standard_normal((60, 5)) * np.array([3.0, 1.0, 0.3, 0.1, 0.01])
    hat = columns @ np.linalg.solve(columns.T @ columns + np.eye(5), columns.T)
    noise = toeplitz(np.r_[1.0, np.zeros(59)])
    taken = hat @ noise + noise @ hat - hat @ noise @ hat
    wanted = [float(np.mean(np.diag(taken, k))) for k in range(LAGS)]
    # White in, white again after each round: the autoregression keeps order 0.
    found = taken_by_fit([columns], np.eye(1, LAGS)[0] * (1.0 - wanted[0]), 60)
    assert found[0] == pytest.approx(wanted[0], rel=0.02)
    assert found[1:] == pytest.approx(wanted[1:], abs=0.02)


@pytest.mark.parametrize(("n", "gives"), [(1000, True), (4000, False)])
def test_a_long_record_is_left_alone(n: int, gives: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []

    def asking(fitted: list[Array], left: Array, rows: float) -> Array:
        asked.append(len(fitted))
        return taken_by_fit(fitted, left, rows)

    monkeypatch.setattr(noise_estimate, "taken_by_fit", asking)
    run = measured(1, n=n)
    with_knowledge(identify_fast([run], FastOptions(12)).model, [run])
    assert bool(asked) == gives


@given(st.lists(st.floats(-1.5, 1.5), min_size=LAGS - 1, max_size=LAGS - 1))
def test_autocovariances_that_no_noise_has_still_give_a_stable_noise(others: list[float]) -> None:
    ar, innovation = autoregression(np.array([1.0, *others]), 50)
    assert 0.0 < innovation <= 1.0
    assert np.max(np.abs(np.roots(np.r_[1.0, -ar])), initial=0.0) < 1.0


@given(feedback=st.floats(-0.95, 0.98), innovation=st.floats(0.1, 2.0))
def test_the_autocovariance_of_a_first_order_noise_fades_by_its_feedback(
    feedback: float, innovation: float
) -> None:
    found = autocovariance(np.array([feedback]), innovation, LAGS)
    expected = innovation**2 / (1.0 - feedback**2) * feedback ** np.arange(LAGS + 1)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)
