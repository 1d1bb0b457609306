"""Bernstein polynomials, evaluated so that every rounding error stays relative.

All terms of a Bernstein sum are products of non-negative factors; nothing is expanded into powers
of x, where a degree of 18 would lose eight digits.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import comb

Array = NDArray[np.float64]


@lru_cache(maxsize=64)
def _binomials(degree: int) -> tuple[float, ...]:
    """All C(d, j) of a degree."""
    return tuple(float(comb(degree, j, exact=True)) for j in range(degree + 1))


def bernstein_basis(x: Array, degree: int) -> Array:
    """Return the Bernstein basis of a degree at given abscissas.

    Parameters
    ----------
    x
        Abscissas in [0, 1], shape (N,).
    degree
        Degree d of the basis, at least 1.

    Returns
    -------
    Array
        ``B[t, j] = C(d, j) x_t^j (1 - x_t)^(d - j)``, shape (N, d + 1), eq. (5) of Mojallali and
        Ahmadi (2011). Column-contiguous, as the least-squares routines want it.
    """
    basis = np.empty((x.size, degree + 1), order="F")
    binomials = _binomials(degree)
    rest = 1.0 - x
    power = np.ones_like(x)
    for j in range(degree + 1):
        np.multiply(power, binomials[j], out=basis[:, j])
        power *= x
    power[:] = 1.0
    for j in range(degree, -1, -1):
        basis[:, j] *= power
        power *= rest
    return basis


def bezier_value(x: Array, coefficients: Array) -> Array:
    """Return ``Σ_j c_j B_j^d(x)`` without forming the basis.

    Parameters
    ----------
    x
        Abscissas in [0, 1], shape (N,).
    coefficients
        Bernstein coefficients c, shape (d + 1,).

    Returns
    -------
    Array
        Values, shape (N,). A nested scheme in x and 1 − x (Farin, Curves and Surfaces for CAGD,
        section 5.4): 4d operations a value, backward stable on the whole interval.
    """
    degree = coefficients.size - 1
    if degree == 0:
        return np.full_like(x, coefficients[0])
    binomials = _binomials(degree)
    rest = 1.0 - x
    total: Array = rest * coefficients[0]
    power = x.copy()
    for j in range(1, degree):
        total += power * (binomials[j] * coefficients[j])
        total *= rest
        power *= x
    total += power * coefficients[degree]
    return total


def bezier_slope(x: Array, coefficients: Array) -> Array:
    """Return the derivative of ``Σ_j c_j B_j^d(x)`` with respect to x.

    Parameters
    ----------
    x
        Abscissas in [0, 1], shape (N,).
    coefficients
        Bernstein coefficients c, shape (d + 1,), d at least 1.

    Returns
    -------
    Array
        Slopes, shape (N,): the Bernstein sum of degree d − 1 over ``d (c_{j+1} − c_j)``.
    """
    degree = coefficients.size - 1
    differences: Array = degree * np.diff(coefficients)
    return bezier_value(x, differences)
