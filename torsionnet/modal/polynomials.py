"""Polynomial bases (powers of z, orthogonal polynomials of s), and roots of matrix polynomials in them.

Powers of z are on the unit circle; the polynomials in s are orthogonal over the lines of a measurement (Forsythe's, as
in Richardson and Formenti, IMAC 1982). On the imaginary axis these are even or odd, so that

    s p_k = b_(k+1) p_(k+1) - b_k p_(k-1)

with one real coefficient for each degree. No powers of s are formed, which would lose digits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.modal.spectral_lines import ComplexArray, FloatArray


@dataclass(frozen=True, eq=False)
class Family:
    """Basis of polynomials of degree 0 to n, with the value of each at every line, (n_f, n + 1).

    Attributes
    ----------
    values : (n_f, n + 1) complex array
        Value of each polynomial at each line.
    up, down : (n,) arrays
        ``x p_k = up[k] p_(k+1) + down[k] p_(k-1)``.
    """

    values: ComplexArray
    up: FloatArray
    down: FloatArray


def powers(z: ComplexArray, degree: int) -> Family:
    """Basis of the powers 1, z, z^2, ... up to a degree, with their values at the lines z."""
    return Family(z[:, None] ** np.arange(degree + 1), np.ones(degree), np.zeros(degree))


def orthogonal(s: ComplexArray, weights: FloatArray, degree: int) -> Family:
    """Basis of polynomials orthonormal over the lines s = j omega under the given weights, up to a degree.

    >>> s = 1j * np.linspace(1, 2, 50)
    >>> values = orthogonal(s, np.ones(50), 3).values
    >>> bool(np.allclose((values.conj().T @ values).real, np.eye(4)))
    True
    """
    omega = s.imag
    real = np.zeros((len(s), degree + 1))
    real[:, 0] = 1 / np.linalg.norm(weights)
    steps = np.zeros(degree + 1)
    for k in range(degree):
        raised = omega * real[:, k] - (steps[k] * real[:, k - 1] if k else 0.0)
        # The recurrence alone loses orthogonality at high degrees; only those of like parity overlap.
        same = real[:, (k + 1) % 2 : k + 1 : 2]
        raised -= same @ (same.T @ (weights**2 * raised))
        steps[k + 1] = np.linalg.norm(weights * raised)
        real[:, k + 1] = raised / steps[k + 1]
    return Family(real * 1j ** np.arange(degree + 1), steps[1:], -steps[:-1])


def roots(coefficients: FloatArray, family: Family) -> tuple[ComplexArray, ComplexArray]:
    """Roots (n m,) of a matrix polynomial ``sum A_k p_k``, where it is singular, and row vectors u with u A = 0.

    Parameters
    ----------
    coefficients : (n + 1, m, m) array
        A_k.
    family : Family

    Returns
    -------
    roots : (n m,) complex array
    rows : (n m, m) complex array
        u with ``u A(root) = 0``.

    Notes
    -----
    Eigenvalues of the comrade matrix: the companion matrix in another basis than powers.
    """
    import scipy.linalg

    degree, size = len(coefficients) - 1, coefficients.shape[1]
    transposed = coefficients.transpose(0, 2, 1)
    comrade = np.zeros((degree, size, degree, size))
    unit = np.eye(size)
    for k in range(degree - 1):
        comrade[k, :, k + 1] = family.up[k] * unit
        comrade[k + 1, :, k] = family.down[k + 1] * unit
    last = np.linalg.lstsq(transposed[-1], np.hstack(list(transposed[:-1])))[0]
    comrade[-1] -= family.up[degree - 1] * last.reshape(size, degree, size)
    found, vectors = scipy.linalg.eig(comrade.reshape(degree * size, degree * size))
    return np.asarray(found), np.asarray(vectors[:size].T)
