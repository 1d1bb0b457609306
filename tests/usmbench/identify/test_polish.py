"""The streamed estimate is that of all rows at once."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from usmbench.identify import pieces
from usmbench.identify.data import Dataset
from usmbench.identify.design import build_design, stacked_basis
from usmbench.identify.dynamics import FreeFamily
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.gather import from_windows
from usmbench.identify.lag_family import LagFamily
from usmbench.identify.output_error import fit_output_error
from usmbench.identify.polish import polished
from usmbench.identify.prior_rows import prior_rows
from usmbench.identify.projected import Projected
from usmbench.identify.robust_fit import RobustFit, bisquare_weights, counted_alike, robust_fit
from usmbench.identify.sensitivities import output_sensitivities
from usmbench.identify.thinning import searched_part
from usmbench.identify.uncertainty import Estimate, covariance
from usmbench.model.hammerstein import LinearPart, StaticCurve
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

Measure = Callable[..., Record]


@pytest.mark.parametrize(
    ("family", "start"),
    [(LagFamily(3.0), np.array([-1.0, 0.2])), (FreeFamily(1, 2, 0), np.array([-0.05, 0.3, 0.0]))],
)
def test_newton_steps_over_pieces_come_to_the_fit_of_all_rows(
    measure: Measure, curve: StaticCurve, family: LagFamily | FreeFamily, start: np.ndarray
) -> None:
    knots_deg = curve.knots_deg
    data = from_windows([measure(30_000, noise_rad_s=0.2)])

    def search(rows: Dataset) -> RobustFit:
        stretches = build_design(rows, [knots_deg])
        priors = [prior_rows(knots_deg, 1e-3, None, rows.n)]
        return robust_fit(Projected(stretches, family, start, counted_alike(stretches), priors))

    few, whole = search(searched_part(data, 5000)), search(data).problem
    for _ in range(5):
        weights = bisquare_weights(whole, (few.settled_rad_s, few.changing_rad_s))
        whole = fit_output_error(whole.reweighted(weights), 1e-9)
    linearised = few.problem.linearised()
    found = polished(data, [knots_deg], family, few, linearised, few.problem.penalties)
    wanted = whole.fit
    estimate = Estimate(family, found, whole.linearised(), 1.0)
    spread = covariance(estimate, whole.penalties)
    off = (found.parameters - wanted.parameters) / np.linalg.norm(spread.dynamics, axis=1)
    assert np.max(np.abs(off)) < 0.35
    (basis,) = stacked_basis([np.linspace(-89.0, 89.0, 30)], knots_deg)
    reach = np.linalg.norm(basis @ spread.delta[0], axis=1)
    assert np.max(np.abs(basis @ (found.delta[0] - wanted.delta[0])) / reach) < 0.35


def test_pieces_run_as_the_whole_does(
    measure: Measure, curve: StaticCurve, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pieces, "PIECE_ROWS", 500)
    data: Dataset = from_windows([measure(3000)])
    linear = LinearPart(np.array([-0.9]), np.array([0.06, 0.04]), 2, 0.01)
    parts = []
    for piece in pieces.pieces(data, linear, 0):
        settled = pieces.settled_speed_rad_s(piece.phase_deg, curve)
        parts.append(free_run(linear, settled, 0.0)[piece.before :])
    segment = data.segments[0]
    whole = free_run(linear, curve.speed_rad_s(segment.phase_deg), 0.0)
    assert np.allclose(np.concatenate(parts), whole, atol=1e-8)


def test_regressors_of_dwells_are_those_of_every_row(curve: StaticCurve) -> None:
    rng = np.random.default_rng(0)
    phase_deg = np.repeat(rng.uniform(-90.0, 90.0, 40), rng.integers(1, 9, 40))
    (basis,) = stacked_basis([phase_deg], curve.knots_deg)
    short = pieces.regressors(phase_deg, curve.knots_deg)
    column, delta = rng.standard_normal(phase_deg.size), rng.standard_normal(curve.delta.size)
    assert np.allclose(short.times(delta), basis @ delta, rtol=1e-12)
    assert np.allclose(short.transposed_times(column), basis.T @ column, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("family", [LagFamily(3.0), FreeFamily(2, 2, 1)])
def test_sensitivities_are_the_derivatives(family: LagFamily | FreeFamily) -> None:
    rng = np.random.default_rng(1)
    v = rng.standard_normal(60)
    lag = isinstance(family, LagFamily)
    parameters = np.array([-1.0, 1.3]) if lag else np.array([-0.8, 0.1, 0.3, -0.1])
    dynamics = family.dynamics(parameters)
    slopes = output_sensitivities(dynamics, v)
    free = FreeFamily(dynamics.a.size, dynamics.beta.size, dynamics.dead_time_windows)
    coefficients = np.r_[dynamics.a, dynamics.beta]
    for k in range(coefficients.size):
        step = 1e-6 * np.eye(coefficients.size)[k]
        up, down = (free.dynamics(coefficients + s * step).respond(v) for s in (1, -1))
        assert np.allclose(slopes[:, k], (up - down) / 2e-6, atol=1e-7)


def test_few_phases_are_warned_of(measure: Measure) -> None:
    record = measure(600)
    coarse = replace(record, phase_deg=60.0 * np.round(record.phase_deg / 60.0))
    found = identify_fast([coarse], FastOptions(degree=12))
    assert "different phases for" in found.warnings[-1]
