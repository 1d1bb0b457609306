import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.sparse import csr_array

from usmbench.diagnose.residual.columns import Columns

Array = NDArray[np.float64]

_N = 40


@st.composite
def _matrices(draw: st.DrawFn) -> tuple[Array, np.random.Generator]:
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    fills = rng.choice([0.0, 0.05, 0.5, 1.0], size=draw(st.integers(0, 8)))
    return rng.standard_normal((_N, fills.size)) * (rng.random((_N, fills.size)) < fills), rng


@given(_matrices())
def test_two_parts_are_the_matrix_but_for_the_order_of_its_columns(
    drawn: tuple[Array, np.random.Generator],
) -> None:
    matrix, rng = drawn
    columns, order = Columns.of(np.split(matrix, [2, 5]))
    same = matrix[:, order]
    amounts = rng.standard_normal((order.size, 3))
    signal = rng.standard_normal((_N, 2))
    np.testing.assert_allclose(columns.combined(amounts), same @ amounts, atol=1e-12)
    np.testing.assert_allclose(columns.combined(amounts[:, 0]), same @ amounts[:, 0], atol=1e-12)
    np.testing.assert_allclose(columns.along(signal), same.T @ signal, atol=1e-12)
    np.testing.assert_allclose(columns.gram, same.T @ same, atol=1e-12)


@given(_matrices(), st.sampled_from([1, 205]))
def test_sizes_of_rows_are_those_of_the_sums_however_many_rows(
    drawn: tuple[Array, np.random.Generator], times: int
) -> None:
    matrix, rng = drawn
    columns, order = Columns.of([np.tile(matrix, (times, 1))])
    amounts = rng.standard_normal((order.size, 3))
    whole = np.linalg.norm(columns.combined(amounts), axis=1)
    np.testing.assert_allclose(columns.size_of_rows(amounts), whole, atol=1e-12)


@given(_matrices())
def test_rows_filters_and_further_columns_are_those_of_the_matrix(
    drawn: tuple[Array, np.random.Generator],
) -> None:
    matrix, rng = drawn
    columns, order = Columns.of(np.split(matrix, [2, 5]))
    rows, further = rng.random(_N) < 0.5, rng.standard_normal((_N, 2))
    filter_ = np.tril(np.triu(rng.standard_normal((_N, _N)), -2))
    changed = columns.filtered(csr_array(filter_)).beside(further).of_rows(rows)
    same = np.column_stack([filter_ @ matrix[:, order], further])[rows]
    whole = changed.combined(np.eye(order.size + 2))
    np.testing.assert_allclose(whole, same, atol=1e-12)


def test_only_full_columns_are_kept_with_their_zeros() -> None:
    columns, order = Columns.of([np.column_stack([np.eye(_N)[:, 3], np.ones(_N), np.zeros(_N)])])
    assert columns.full.shape == (_N, 1)
    assert columns.empty.nnz == 1
    assert order.tolist() == [1, 0, 2]
