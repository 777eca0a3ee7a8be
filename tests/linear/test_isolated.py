"""Isolated eigenvalues in many digits, against the roots of characteristic polynomials written down by hand."""

import mpmath
import numpy as np
import pytest

from torsionnet.linear.assembly.rows import Rows
from torsionnet.linear.modes.ehrlich_aberth import isolated_root, isolation_radii, polynomial

J, C, SOFT, STIFF = 2.0, 3e-7, 5e-3, 7e11
ROWS = Rows.of(np.array([[1.0, 0.0], [0.0, 1.0], [1.0, -1.0]]))


def exact_roots(damping):
    """Of det [[J z^2 + c z + k + K, -K], [-K, J z^2 + K]] with k = SOFT to ground and K = STIFF between."""
    with mpmath.workdps(80):
        j, c, k, stiff = (mpmath.mpf(value) for value in (J, damping, SOFT, STIFF))
        return mpmath.polyroots([j * j, j * c, j * (k + 2 * stiff), c * stiff, k * stiff], maxsteps=500, extraprec=500)


def problem(damping):
    laws = [np.array([SOFT, 0.0, STIFF]), np.array([damping, 0.0, 0.0]), np.array([J, J, 0.0])]
    return polynomial(ROWS, laws)


@pytest.mark.parametrize("off", [1e-6, 1e-3])
@pytest.mark.parametrize("number", range(4))
def test_all_digits_from_a_rough_start(number, off):
    root = exact_roots(C)[number]
    shape = np.array([0.9, 1.2 if abs(root) < 1 else -0.8], dtype=complex)
    found, motion = isolated_root(problem(C), complex(root) * (1 + off), shape, abs(complex(root)) / 2)
    # The real parts are 1e-19 of the imaginary ones for the stiff mode: both must be right.
    assert float(found.real) == pytest.approx(float(root.real), rel=1e-12)
    assert float(found.imag) == pytest.approx(float(root.imag), rel=1e-15)
    assert motion[1] / motion[0] == pytest.approx(1 if abs(root) < 1 else -1, abs=1e-9)


def test_a_start_that_leaves_its_free_space_is_refused():
    slow = min(abs(complex(root)) for root in exact_roots(0.0))
    motion = np.array([1.0, 1.0], dtype=complex)
    assert isolated_root(problem(0.0), 1.3j * slow, motion, slow) is not None
    assert isolated_root(problem(0.0), 1.3j * slow, motion, 0.3 * slow) is None


def test_free_space_is_what_uncertainty_leaves():
    roots = np.array([1.0, 2.0, 2.0 + 1e-6, 50.0])
    np.testing.assert_allclose(isolation_radii(roots, np.zeros(4)), [1.0, 1e-6, 1e-6, 48.0], rtol=1e-6)
    np.testing.assert_array_equal(isolation_radii(roots, np.array([0, 1e-9, 0, 0])) > 0, [True, False, False, True])
    np.testing.assert_array_equal(isolation_radii(roots, np.array([0, 0, 0, np.inf])) > 0, [False] * 4)
    np.testing.assert_array_equal(isolation_radii(np.array([3.0]), np.array([0.5])), [0.0])
