"""Tests of the residual reject at their stated rate, and see what they are for."""

import numpy as np
import pytest
from scipy.stats import binom

from usmbench.identify.noise import coloured_back, fit_noise, whitened
from usmbench.identify.residual_tests import FittedRows, input_test, serial_test

SETS, N = 300, 400


def fitted(
    rng: np.random.Generator, noise: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Residual and regressors of a fit to a signal with this noise, and further inputs."""
    signal = rng.standard_normal(N + 12)
    regressors = np.column_stack([signal[12 - k : N + 12 - k] for k in range(2)])
    inputs = np.column_stack([signal[12 - k : N + 12 - k] for k in range(2, 12)])
    outcome = regressors @ np.array([1.0, 0.5]) + noise
    estimate = np.linalg.lstsq(regressors, outcome, rcond=None)[0]
    return outcome - regressors @ estimate, regressors, inputs


def test_false_alarms_come_at_five_per_cent_over_all_lags() -> None:
    rng = np.random.default_rng(0)
    serial, other = 0, 0
    for _ in range(SETS):
        residual, regressors, inputs = fitted(rng, rng.standard_normal(N))
        serial += serial_test(FittedRows([residual], [regressors])).p_value < 0.05
        other += input_test(FittedRows([residual], [regressors]), [inputs]).p_value < 0.05
    low, high = (float(binom.ppf(tail, SETS, 0.05)) for tail in (0.0005, 0.9995))
    assert low <= serial <= high
    assert low <= other <= high


def test_false_alarms_come_at_five_per_cent_where_a_colour_was_taken_out() -> None:
    rng, alarms, taken = np.random.default_rng(4), 0, []
    far_back = np.r_[np.zeros(7), 0.5]  # a colour that takes eight coefficients
    for _ in range(SETS):
        noise = coloured_back(far_back, rng.standard_normal(5 * N))
        colour, _ = fit_noise([noise])
        white = whitened(colour, noise)[colour.size :]
        taken.append(colour.size)
        fit = FittedRows([white], [np.ones((white.size, 1))])
        alarms += serial_test(fit, colour.size).p_value < 0.05
    low, high = (float(binom.ppf(tail, SETS, 0.05)) for tail in (0.0005, 0.9995))
    assert min(taken) >= 8
    assert low <= alarms <= high


def test_a_weak_colour_is_seen() -> None:
    rng = np.random.default_rng(1)
    white = rng.standard_normal(N + 1)
    residual, regressors, _ = fitted(rng, white[1:] + 0.6 * white[:-1])
    assert serial_test(FittedRows([residual], [regressors])).p_value < 1e-6


def test_a_missing_lag_of_the_input_is_seen() -> None:
    rng = np.random.default_rng(2)
    residual, regressors, inputs = fitted(rng, rng.standard_normal(N))
    assert (
        input_test(FittedRows([residual + 0.4 * inputs[:, 1]], [regressors]), [inputs]).p_value
        < 1e-6
    )


def test_columns_that_say_nothing_new_say_nothing() -> None:
    rng = np.random.default_rng(3)
    residual, regressors, _ = fitted(rng, rng.standard_normal(N))
    test = input_test(
        FittedRows([residual], [regressors]), [regressors @ rng.standard_normal((2, 4))]
    )
    assert (test.degrees, test.p_value) == (0, 1.0)


def test_noise_of_a_known_colour_is_found_and_taken_out() -> None:
    rng = np.random.default_rng(4)
    white = rng.standard_normal(20_000)
    noise = np.zeros(white.size)
    for t in range(2, white.size):
        noise[t] = 1.2 * noise[t - 1] - 0.5 * noise[t - 2] + white[t]
    coefficients, level = fit_noise([noise])
    assert coefficients == pytest.approx([1.2, -0.5], abs=0.03)
    assert level == pytest.approx(1.0, abs=0.02)
    assert np.corrcoef(whitened(coefficients, noise)[1:], whitened(coefficients, noise)[:-1])[
        0, 1
    ] == pytest.approx(0.0, abs=0.03)


def test_white_noise_has_no_colour() -> None:
    pieces = [np.random.default_rng(5).standard_normal(500) for _ in range(3)]
    coefficients, level = fit_noise(pieces)
    assert coefficients.size == 0
    assert level == pytest.approx(1.0, abs=0.1)


def test_coloured_back_gives_the_covariance_of_weighted_sums() -> None:
    coefficients = np.array([0.6])
    rows = np.zeros((200, 3))
    rows[60:] = np.random.default_rng(6).standard_normal((140, 3))  # the filter starts at rest
    lag = np.abs(np.subtract.outer(np.arange(200), np.arange(200)))
    exact = rows.T @ (0.6**lag / (1 - 0.36)) @ rows
    back = coloured_back(coefficients, rows)
    assert np.allclose(back.T @ back, exact, rtol=1e-9, atol=1e-9)
