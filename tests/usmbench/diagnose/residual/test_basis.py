"""An orthonormal basis as amounts of the columns that it is made from."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from usmbench.diagnose.residual.basis import Basis

_M = 30


@given(st.integers(0, 2**32 - 1), st.integers(0, 6), st.integers(0, 2))
def test_a_basis_spans_its_columns_and_nothing_else(seed: int, n: int, n_repeated: int) -> None:
    rng = np.random.default_rng(seed)
    apart = rng.standard_normal((_M, n)) * 10.0 ** rng.integers(-3, 4, n)
    columns = np.column_stack([apart, np.zeros(_M), *[apart.sum(axis=1)] * n_repeated])
    basis = Basis.of(columns)
    assert basis.rank == n
    np.testing.assert_allclose(basis.vectors.T @ basis.vectors, np.eye(n), atol=1e-6)
    carried = rng.standard_normal(_M)
    rest = basis.rest(carried)
    np.testing.assert_allclose(basis.vectors.T @ rest, 0.0, atol=1e-6)
    np.testing.assert_allclose(basis.square(carried) + rest @ rest, carried @ carried, rtol=1e-6)
    inside = columns @ rng.standard_normal(columns.shape[1])
    np.testing.assert_allclose(basis.rest(inside), 0.0, atol=1e-6 * (1.0 + np.abs(inside).max()))
