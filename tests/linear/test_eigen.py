"""Eigenvalues of row systems: closed forms, published values, and exact rational inclusion on graded chains."""

from fractions import Fraction
from math import pi

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import campaigns

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import Rows, RowSystem
from torsionnet.linear.dynamic_stiffness.row_algebra import unresisted_motions
from torsionnet.linear.modes import ehrlich_aberth
from torsionnet.linear.modes import spectrum as spectrum_module
from torsionnet.linear.modes.eigen import complex_modes, undamped_modes
from torsionnet.model.element_base.dynamic_stiffness import ComplexStiffness, DynamicStiffness

# --- builders -------------------------------------------------------------------------------------------------------


def system(*laws, dynamic=()):
    """Rows from (row, J, c, k)."""
    rows, J, c, k = zip(*laws, strict=True)
    return RowSystem(
        Rows.of(np.array(rows, float)), np.array(J, float), np.array(c, float), np.array(k, float), tuple(dynamic)
    )


def chain(inertias, springs, dampers=None, ground=None, drag=None):
    n = len(inertias)
    dampers = np.zeros(n - 1) if dampers is None else dampers
    nodes = [(np.eye(n)[i], inertias[i], drag[i] if drag else 0, ground[i] if ground else 0) for i in range(n)]
    links = [(np.eye(n)[i] - np.eye(n)[i + 1], 0, dampers[i], springs[i]) for i in range(n - 1)]
    return system(*nodes, *links)


def graded_chain(seed, n=6, massless=0, damped=True):
    """k from 1e2 to 1e10, J from 1e-6 to 1e6, c from 1e-4 to 1e6; clamped for odd seeds."""
    rng = np.random.default_rng(seed)
    inertias = 10 ** rng.uniform(-6, 6, n)
    inertias[rng.choice(n, massless, replace=False)] = 0
    c = 10 ** rng.uniform(-4, 6, 2 * n - 1) * (rng.random(2 * n - 1) < 0.5) * damped
    k = 10 ** rng.uniform(2, 10, n)
    return chain(inertias, k[1:], c[n:], [k[0] * (seed % 2), *[0] * (n - 1)], list(c[:n]))


def rigid_count(modes):
    return modes.kinds.count("rigid body")


def oscillatory(modes):
    return modes.eigenvalues[[kind == "oscillatory" for kind in modes.kinds]]


def real_poles(modes):
    return np.sort(modes.eigenvalues.real[[kind == "real pole" for kind in modes.kinds]])


def residual(s, modes):
    """Largest |D(lambda) q| against the sum of the magnitudes of its terms."""
    worst = 0.0
    for lam, q in zip(modes.eigenvalues, modes.vectors.T, strict=True):
        law = s.inertia * lam**2 + s.damping * lam + s.stiffness + s.kappa(abs(lam.imag))
        size = s.inertia * abs(lam) ** 2 + s.damping * abs(lam) + s.stiffness + abs(s.kappa(abs(lam.imag)))
        scale = np.abs(s.rows).T @ (size * (np.abs(s.rows) @ np.abs(q)))
        worst = max(worst, np.linalg.norm(s.rows.T @ (law * (s.rows @ q))) / max(np.linalg.norm(scale), 1e-300))
    return worst


# --- exact reference ------------------------------------------------------------------------------------------------


def exact_polynomial(s):
    """Coefficients (ascending) of det D(s) in rationals without its zero roots, and their number."""
    n = s.n_coordinates
    M, C, K = (
        [
            [sum(F(r[i]) * F(r[j]) * F(v) for r, v in zip(s.rows, values, strict=True) if v) for j in range(n)]
            for i in range(n)
        ]
        for values in (s.inertia, s.damping, s.stiffness)
    )
    points = range(2 * n + 1)
    values = [
        determinant([[M[i][j] * x * x + C[i][j] * x + K[i][j] for j in range(n)] for i in range(n)]) for x in points
    ]
    for order in points[1:]:
        for i in reversed(points[order:]):
            values[i] = (values[i] - values[i - 1]) / order
    result = [Fraction(0)]
    for x, value in reversed(list(zip(points, values, strict=True))):
        shifted = [Fraction(0), *result]
        result = [a - x * b for a, b in zip(shifted, [*result, Fraction(0)], strict=True)]
        result[0] += value
    while result[-1] == 0:
        result.pop()
    zeros = next(i for i, value in enumerate(result) if value)
    return result[zeros:], zeros


def F(value):
    return Fraction(float(value))


def determinant(A):
    n, det = len(A), Fraction(1)
    for c in range(n):
        pivot = next((i for i in range(c, n) if A[i][c]), None)
        if pivot is None:
            return Fraction(0)
        if pivot != c:
            A[c], A[pivot], det = A[pivot], A[c], -det
        det *= A[c][c]
        for i in range(c + 1, n):
            factor = A[i][c] / A[c][c]
            if factor:
                A[i] = [a - factor * b for a, b in zip(A[i], A[c], strict=True)]
    return det


def inclusion(s, modes):
    """Largest relative radius n |p/p'| around an eigenvalue; each disc holds a root, and the discs are disjoint."""
    coefficients, zeros = exact_polynomial(s)
    rigid = rigid_count(modes)
    assert rigid == s.n_coordinates - np.linalg.matrix_rank(s.rows[s.stiffness > 0])
    assert zeros == rigid + unresisted_motions(s, (s.stiffness > 0) | (s.damping > 0)).dimension
    values = modes.eigenvalues[rigid:]
    every = np.concatenate([values, values[values.imag > 0].conj()])
    assert len(every) == len(coefficients) - 1
    with mpmath.workdps(250):
        p = [mpmath.mpf(c.numerator) / c.denominator for c in reversed(coefficients)]
        at = [mpmath.polyval(p, mpmath.mpmathify(complex(z)), derivative=True) for z in every]
        radii = np.array([float(len(every) * abs(v / d)) for v, d in at])
    gaps = np.abs(every[:, None] - every) + np.diag(np.full(len(every), np.inf))
    assert np.all(gaps > radii[:, None] + radii)
    return float(np.max(radii / np.abs(every), initial=0.0))


# --- closed forms ---------------------------------------------------------------------------------------------------


def test_two_masses():
    s = chain([2.0, 3.0], [700.0], [0.4])
    modes = complex_modes(s)
    a, b = 0.4 * (1 / 2 + 1 / 3), 700 * (1 / 2 + 1 / 3)
    assert modes.kinds == ("rigid body", "oscillatory")
    np.testing.assert_allclose(modes.eigenvalues, [0, -a / 2 + 1j * np.sqrt(b - a * a / 4)], rtol=1e-14)
    np.testing.assert_allclose(modes.vectors, [[1, 1], [1, -2 / 3]], atol=1e-14)


def test_two_masses_shape_is_scaled_to_its_largest_component():
    modes = complex_modes(chain([3.0, 2.0], [700.0], [0.4]))
    np.testing.assert_allclose(modes.vectors, [[1, -2 / 3], [1, 1]], atol=1e-14)
    assert np.all(modes.vectors[:, 0].imag == 0)


def test_kelvin_voigt_massless_node():
    modes = complex_modes(system(([1], 0, 0.5, 10.0)))
    assert modes.kinds == ("real pole",)
    np.testing.assert_allclose(modes.eigenvalues, -20, rtol=1e-14)


def test_maxwell_massless_node():
    J, c, k = 2.0, 3.0, 11.0
    s = system(([1, 0], J, 0, 0), ([1, -1], 0, 0, k), ([0, 1], 0, c, 0))
    modes = complex_modes(s)
    expected = np.roots([J * c / k, J, c])
    assert modes.kinds == ("rigid body", "oscillatory")
    np.testing.assert_allclose(modes.eigenvalues[1], expected[expected.imag > 0][0], rtol=1e-13)
    assert residual(s, modes) < 1e-14


def test_massless_node_between_springs_is_eliminated():
    series = 1 / (1 / 500.0 + 1 / 300.0)
    s = chain([1.0, 0.0, 2.0], [500.0, 300.0])
    omega, shapes = undamped_modes(s)
    np.testing.assert_allclose(omega, [0, np.sqrt(series * 1.5)], rtol=1e-14)
    np.testing.assert_allclose(shapes[:, 1], [1, (500 - 150) / 800, -0.5], rtol=1e-13)
    np.testing.assert_allclose(complex_modes(s).eigenvalues, 1j * omega, rtol=1e-14)


@pytest.mark.parametrize("drag", [0.0, 0.5])
def test_free_inertia_with_and_without_drag(drag):
    modes = complex_modes(system(([1], 2.0, drag, 0)))
    expected = [0.0, -drag / 2] if drag else [0.0]
    np.testing.assert_array_equal(modes.eigenvalues, expected)
    assert modes.kinds == ("rigid body", "real pole")[: len(expected)]


def test_damper_on_one_of_two_free_trains():
    one = [([1, 0, 0, 0], 1, 0.1, 0), ([0, 1, 0, 0], 2, 0, 0), ([1, -1, 0, 0], 0, 0, 5)]
    two = [([0, 0, 1, 0], 3, 0, 0), ([0, 0, 0, 1], 4, 0, 0), ([0, 0, 1, -1], 0, 0, 6)]
    modes = complex_modes(system(*one, *two))
    assert modes.kinds == ("rigid body",) * 2 + ("real pole",) + ("oscillatory",) * 2
    np.testing.assert_allclose(modes.vectors[:, :2], [[1, 0], [1, 0], [0, 1], [0, 1]], atol=1e-15)
    undamped = 1j * np.sqrt(6 * (1 / 3 + 1 / 4))
    assert np.min(np.abs(oscillatory(modes) - undamped)) < 1e-14


def test_inertias_joined_by_a_damper_only():
    modes = complex_modes(chain([1.0, 2.0], [0.0], [3.0]))
    assert modes.kinds == ("rigid body", "rigid body", "real pole")
    np.testing.assert_allclose(modes.eigenvalues[2], -4.5, rtol=1e-14)


def test_critical_damping():
    modes = complex_modes(system(([1], 1.0, 2.0, 1.0)))
    assert modes.kinds == ("real pole", "real pole")
    np.testing.assert_allclose(modes.eigenvalues, -1, rtol=1e-14)


def test_nearly_critical_damping_of_inexact_numbers():
    c = 2 * np.sqrt(3.0 * 0.7)
    modes = complex_modes(system(([1], 3.0, c, 0.7)))
    np.testing.assert_allclose(modes.eigenvalues, -c / 6, rtol=1e-7)
    assert sum(2 if kind == "oscillatory" else 1 for kind in modes.kinds) == 2


def test_heavy_overdamping_keeps_the_slow_pole():
    modes = complex_modes(system(([1], 1.0, 1e8, 1e-3)))
    np.testing.assert_allclose(modes.eigenvalues, [-1e-11, -1e8], rtol=1e-14)


def test_slow_pole_that_double_precision_rounds_to_zero():
    """A massless node with little drag between stiff springs and a damper: poles at -1e-4 and -2e13 rad/s."""
    s = system(([1, 0], 0.5, 0, 0), ([0, 1], 0, 1.5e-5, 0), ([1, -0.5], 0, 0, 1e9))
    modes = complex_modes(s)
    assert modes.kinds == ("rigid body", "real pole", "real pole")
    np.testing.assert_allclose(modes.eigenvalues[1], -6e-5 / 0.5, rtol=1e-9)
    assert inclusion(s, modes) < 1e-12


def test_large_damper_in_series_with_a_tiny_one():
    s = system(([1, 0], 2e-3, 0, 0), ([0, 1], 0, 4e-5, 0), ([-8, 2], 0, 3e5, 0))
    modes = complex_modes(s)
    expected = -1 / (2e-3 * (1 / (4e-5 * 16) + 1 / (3e5 * 64)))
    np.testing.assert_allclose(real_poles(modes), [expected], rtol=1e-13)


def test_uniform_free_chain_of_50():
    omega = 2 * np.sqrt(2.5e5 / 0.8) * np.sin(np.arange(50) * pi / 100)
    s = chain([0.8] * 50, [2.5e5] * 49)
    np.testing.assert_allclose(complex_modes(s).eigenvalues, 1j * omega, rtol=1e-9)
    np.testing.assert_allclose(undamped_modes(s)[0], omega, rtol=1e-9)


def test_uniform_clamped_chain_of_200():
    n = 200
    omega = 2 * np.sqrt(2.5e5 / 0.8) * np.sin(np.arange(1, n + 1) * pi / (2 * (n + 1)))
    walls = [2.5e5, *[0] * (n - 2), 2.5e5]
    undamped = complex_modes(chain([0.8] * n, [2.5e5] * (n - 1), ground=walls))
    np.testing.assert_allclose(undamped.eigenvalues, 1j * omega, rtol=1e-8)


def test_rayleigh_damping():
    n, alpha, beta = 6, 0.6, 2e-4
    omega = 2 * np.sqrt(2.5e5 / 0.8) * np.sin((2 * np.arange(1, n + 1) - 1) * pi / (2 * (2 * n + 1)))
    drag = [0.8 * alpha + 2.5e5 * beta, *[0.8 * alpha] * (n - 1)]
    modes = complex_modes(chain([0.8] * n, [2.5e5] * (n - 1), [50.0] * (n - 1), [2.5e5, *[0] * (n - 1)], drag))
    zeta = alpha / (2 * omega) + beta * omega / 2
    np.testing.assert_allclose(np.abs(modes.eigenvalues), omega, rtol=1e-12)
    np.testing.assert_allclose(-modes.eigenvalues.real / omega, zeta, rtol=1e-11)


def kahraman_rows():
    """Carrier, three planets, sun; ring fixed (Kahraman 1994, J. Sound Vib. 173(1))."""
    laws = [(np.eye(5)[i], J, 0, 0) for i, J in enumerate([4.0, 0.75, 0.75, 0.75, 0.5])]
    for planet in np.eye(5)[1:4]:
        laws.append((np.eye(5)[0] + 0.5 * planet, 0, 0, 11.0))
        laws.append((-np.eye(5)[0] + 0.5 * planet + 0.5 * np.eye(5)[4], 0, 0, 7.0))
    return laws


KAHRAMAN_HZ = [0.0, 0.38984840061683806, 0.38984840061683806, 0.5087289700947163, 0.7078867934238514]


def test_repeated_planet_modes():
    omega, shapes = undamped_modes(system(*kahraman_rows()))
    np.testing.assert_allclose(omega / 2 / pi, KAHRAMAN_HZ, rtol=1e-12)
    assert np.linalg.matrix_rank(shapes[:, 1:3]) == 2
    np.testing.assert_allclose(shapes[[0, 4], 1:3], 0, atol=1e-13)


def test_repeated_planet_modes_with_proportional_damping():
    beta = 0.02
    s = system(*[(row, J, beta * k, k) for row, J, _, k in kahraman_rows()])
    modes = complex_modes(s)
    omega = 2 * pi * np.array(KAHRAMAN_HZ[1:])
    zeta = beta * omega / 2
    np.testing.assert_allclose(modes.eigenvalues[1:], omega * (-zeta + 1j * np.sqrt(1 - zeta**2)), rtol=1e-11)
    assert np.linalg.matrix_rank(modes.vectors[:, 1:3], tol=1e-3) == 2


def test_shape_on_an_exact_root():
    p = ehrlich_aberth.polynomial(Rows.of(np.eye(2)), [np.array([4.0, 9.0]), np.zeros(2), np.ones(2)])
    shape = ehrlich_aberth.refine_vector(p, mpmath.mpc(0, 2), np.array([0.9, 0.3 + 0j]))
    np.testing.assert_allclose(shape, [1, 0], atol=1e-20)


def test_repeated_modes_survive_refinement(monkeypatch):
    monkeypatch.setattr(spectrum_module, "REFINE_ABOVE", 0.0)
    test_repeated_planet_modes()
    test_repeated_planet_modes_with_proportional_damping()


# --- published values -----------------------------------------------------------------------------------------------


def paper(I_1, I_2, k_1, k_2, c_1, c_2, c_M=0.3):
    """Galvagno et al. (2015), eq. (14), both rigs."""
    return system(([1, 0], I_1, c_M, 0), ([0, 1], I_2, c_2, k_2), ([1, -1], 0, c_1, k_1))


def amt(tau, c_O=170.0):
    return paper(0.23, 0.13, 460.0, 12.3e3 / tau**2, 4.0, c_O / tau**2 + 1.5)


@pytest.mark.parametrize(
    ("rig", "hz", "zeta"),
    [
        (paper(0.078, 0.152, 13.3e3, 460.0, 0.1, 4.3), [7.10526, 80.98336], [0.222666, 0.0139479]),
        (amt(7.96), [3.40910, 12.84054], [0.229278, 0.445092]),
        (amt(5.42), [4.56396, 14.08623], [0.224239, 0.523452]),
        (amt(4.14), [5.34326, 15.75178], [0.221185, 0.618605]),
        (amt(3.26), [5.91200, 18.07941], [0.217563, 0.738963]),
    ],
)
def test_rigs_of_the_paper(rig, hz, zeta):
    values = complex_modes(rig).eigenvalues
    np.testing.assert_allclose(np.abs(values) / 2 / pi, hz, rtol=2e-6)
    np.testing.assert_allclose(-values.real / np.abs(values), zeta, rtol=4e-6)


def test_fifth_gear_with_more_drag_is_overdamped():
    modes = complex_modes(amt(3.26, c_O=360.0))
    assert modes.kinds == ("oscillatory", "real pole", "real pole")
    np.testing.assert_allclose(real_poles(modes), [-254.68866, -45.07714], rtol=1e-7)
    assert np.all(modes.vectors[:, 1:].imag == 0)


def test_geared_train_with_drag():
    """Inertias d1-d2-d3 = d4 * 8 - d5; values recomputed with 40 digits."""
    e = np.eye(4)
    d4 = e[2] / 8
    s = system(
        (e[0], 0.5, 0, 0), (e[1], 0.1, 0, 0), (e[2], 0.5, 0.2, 0), (d4, 0.1, 0.2, 0), (e[3], 1.0, 5.0, 0),
        (e[0] - e[1], 0, 10.0, 5000.0), (e[1] - e[2], 0, 0.8, 500.0), (d4 - e[3], 0, 5.0, 1000.0),
    )  # fmt: skip
    modes = complex_modes(s)
    hz = [5.0186217209930675, 6.64200684027979, 40.3537569286118]
    np.testing.assert_allclose(np.sort(np.abs(oscillatory(modes))) / 2 / pi, hz, rtol=1e-9)
    np.testing.assert_allclose(real_poles(modes), [-0.2518388680206913], rtol=1e-9)
    assert rigid_count(modes) == 1


def test_loop_with_inconsistent_ratios_has_no_rigid_body():
    row = lambda ratio: [1 / ratio[0], -1 / ratio[1]]  # noqa: E731
    s = system(
        ([1, 0], 0.4, 0, 0), ([2, 0], 0.05, 0, 0), ([0, 2.1], 0.06, 0, 0), ([0, 1], 0.5, 0, 0),
        (row((0.5, 1 / 2.1)), 0, 0, 3e4), ([1, -1], 0, 0, 9e4),
    )  # fmt: skip
    np.testing.assert_allclose(undamped_modes(s)[0] / 2 / pi, [1.5254549000998825, 127.38843464908575], rtol=1e-9)


def test_parallel_springs_and_loops_add_no_zero_eigenvalues():
    triangle = [([1, -1, 0], 0, 0, 50.0), ([0, 1, -1], 0, 0, 70.0), ([1, 0, -1], 0, 0, 20.0), ([1, -1, 0], 0, 0, 30.0)]
    s = system(([1, 0, 0], 1, 0, 0), ([0, 1, 0], 2, 0.3, 0), ([0, 0, 1], 3, 0, 0), *triangle)
    modes = complex_modes(s)
    assert modes.kinds == ("rigid body", "real pole", "oscillatory", "oscillatory")
    assert inclusion(s, modes) < 1e-12


# --- accuracy and stability on graded systems -----------------------------------------------------------------------


@pytest.mark.few(1)
@pytest.mark.parametrize("massless", [0, 1, 2, 3])
@pytest.mark.parametrize("damped", [True, False])
def test_graded_chains_against_exact_arithmetic(massless, damped):
    for seed in range(8):
        s = graded_chain(100 * massless + seed, massless=massless, damped=damped)
        modes = complex_modes(s)
        assert inclusion(s, modes) < 1e-9
        assert np.all(modes.eigenvalues.real <= 0)
        assert residual(s, modes) < 1e-10
        assert damped or np.all(modes.eigenvalues.real == 0)


def test_graded_chains_need_the_refinement(monkeypatch):
    """Guards the test above: without refinement it fails."""
    s = graded_chain(29, massless=2)
    before = complex_modes(s).eigenvalues
    assert np.all(before != 0)
    monkeypatch.setattr(spectrum_module, "REFINE_ABOVE", np.inf)
    assert np.max(np.abs(complex_modes(s).eigenvalues - before) / np.abs(before)) > 1e-4


@settings(max_examples=campaigns.examples(25, 60), deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 5), st.integers(0, 2))
def test_no_stable_model_has_an_unstable_pole(seed, n, massless):
    for refine_above in (1e-10, np.inf):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(spectrum_module, "REFINE_ABOVE", refine_above)
            assert np.all(complex_modes(graded_chain(seed, n, min(massless, n - 1))).eigenvalues.real <= 0)


def test_undamped_frequencies_of_graded_chains_agree_with_the_eigenvalues():
    for seed in range(10):
        s = graded_chain(seed, massless=seed % 3, damped=False)
        np.testing.assert_allclose(undamped_modes(s)[0], complex_modes(s).eigenvalues.imag, rtol=1e-9)


@pytest.mark.parametrize("ratio", [0.2, 5.0])
def test_long_gear_train_locked_at_one_end_has_no_rigid_body(ratio):
    n = 25
    laws = [(np.eye(n)[i], 1.0, 0, 1e3 * (i == 0)) for i in range(n)]
    laws += [(np.eye(n)[i] - ratio * np.eye(n)[i + 1], 0, 0, 1e3) for i in range(n - 1)]
    assert rigid_count(complex_modes(system(*laws))) == 0


# --- frequency-dependent laws ---------------------------------------------------------------------------------------


def hysteretic(k, eta):
    return ComplexStiffness(k * (1 + 1j * eta))


class OfFunction(DynamicStiffness):
    """Whatever a function of omega says."""

    is_passive = holds_at_rest = True

    def __init__(self, function):
        self.kappa = function

    kappa = kappa_rate = None


rising = OfFunction(lambda omega: (100 + 10 * omega) * (1 + 0.1j))


def test_hysteretic_spring():
    modes = complex_modes(system(([1], 2.0, 0, 0), dynamic=[(0, hysteretic(50.0, 0.3))]))
    np.testing.assert_allclose(modes.eigenvalues, 5j * np.sqrt(1 + 0.3j), rtol=1e-14)
    assert modes.converged.all()


def test_hysteretic_coupling_of_two_free_inertias():
    s = system(([1, 0], 1, 0, 0), ([0, 1], 2, 0, 0), ([1, -1], 0, 0, 0), dynamic=[(2, hysteretic(1e3, 0.1))])
    modes = complex_modes(s)
    np.testing.assert_allclose(modes.eigenvalues, [0, 1j * np.sqrt(1500 * (1 + 0.1j))], rtol=1e-14)
    np.testing.assert_allclose(undamped_modes(s)[0], [0, np.sqrt(1500)], rtol=1e-14)


def test_overdamped_with_hysteresis_gives_the_real_poles_at_rest():
    modes = complex_modes(system(([1], 2.0, 200.0, 0), dynamic=[(0, hysteretic(50.0, 0.3))]))
    assert modes.kinds == ("real pole", "real pole")
    np.testing.assert_allclose(real_poles(modes), np.sort(np.roots([2, 200, 50])), rtol=1e-12)


def test_overdamped_inertia_beside_an_oscillating_one_with_hysteresis():
    nodes = ([1, 0], 1, 100.0, 0), ([0, 1], 1, 0, 0), ([1, -1], 0, 0, 0.01)
    s = system(*nodes, dynamic=[(0, hysteretic(1.0, 0.2)), (1, hysteretic(100.0, 0.2))])
    modes = complex_modes(s)
    assert sorted(modes.kinds) == ["oscillatory", "real pole", "real pole"]
    np.testing.assert_allclose(oscillatory(modes), 10j * np.sqrt(1 + 0.2j), rtol=1e-3)
    np.testing.assert_allclose(real_poles(modes), np.sort(np.roots([1, 100, 1.01])), rtol=1e-3)


def test_graded_hysteretic_chain_is_refined():
    J, k, eta = np.array([1e-5, 3e4, 2.0]), np.array([1e10, 1e2]), 0.2
    s = system(
        *[(np.eye(3)[i], J[i], 0, 0) for i in range(3)],
        ([1, -1, 0], 0, 0, 0), ([0, 1, -1], 0, 0, 0),
        dynamic=[(3, hysteretic(k[0], eta)), (4, hysteretic(k[1], eta))],
    )  # fmt: skip
    omega = undamped_modes(s)[0]
    np.testing.assert_allclose(complex_modes(s).eigenvalues, 1j * omega * np.sqrt(1 + 1j * eta), rtol=1e-12)


def test_stiffness_rising_with_frequency_is_a_fixed_point():
    modes = complex_modes(system(([1], 2.0, 0.3, 0), dynamic=[(0, rising)]))
    (lam,) = modes.eigenvalues
    assert abs(2 * lam**2 + 0.3 * lam + rising.kappa(lam.imag)) < 1e-10 * abs(rising.kappa(lam.imag))
    assert modes.converged.all()
    assert modes.iterations.max() <= 8
    omega, _ = undamped_modes(system(([1], 2.0, 0.3, 0), dynamic=[(0, rising)]))
    np.testing.assert_allclose(omega, np.roots([2, -10, -100]).max(), rtol=1e-12)


def test_repeated_modes_with_frequency_dependent_branches():
    branches = [(np.eye(4)[0] - np.eye(4)[i], 0, 0, 0) for i in (1, 2, 3)]
    nodes = [(np.eye(4)[i], 5.0 if i == 0 else 1.0, 0, 0) for i in range(4)]
    s = system(*nodes, *branches, dynamic=[(i, rising) for i in (4, 5, 6)])
    modes = complex_modes(s)
    assert modes.kinds == ("rigid body",) + ("oscillatory",) * 3
    np.testing.assert_allclose(modes.eigenvalues[1], modes.eigenvalues[2], rtol=1e-11)
    assert np.linalg.matrix_rank(modes.vectors[:, 1:3], tol=1e-3) == 2
    assert residual(s, modes) < 1e-10


def test_jumping_stiffness_is_reported_as_not_converged():
    jump = OfFunction(lambda omega: np.where(omega < 6, 100.0, 50.0) + 0j)
    modes = complex_modes(system(([1], 2.0, 0, 0), dynamic=[(0, jump)]))
    assert not modes.converged.any()


# --- errors and limits ----------------------------------------------------------------------------------------------


def test_coordinate_on_which_nothing_acts():
    with pytest.raises(SolveError, match="1 coordinate"):
        complex_modes(system(([1, 0], 1, 0, 1)))


def test_undamped_modes_ignore_nodes_held_by_dampers_only():
    s = system(([1, 0], 1, 0, 4.0), ([1, -1], 0, 3.0, 0))
    omega, shapes = undamped_modes(s)
    np.testing.assert_allclose(omega, [2.0], rtol=1e-15)
    np.testing.assert_array_equal(shapes, [[1], [0]])


def test_nothing_left_to_move():
    locked = RowSystem(Rows.of(np.zeros((1, 0))), np.ones(1), np.zeros(1), np.zeros(1))
    assert complex_modes(locked).kinds == ()
    assert undamped_modes(locked)[0].shape == (0,)


def test_roots_without_a_right_start_are_given_up_in_time(monkeypatch):
    """40 shafts of a size between 1e-9 and 1e30 whose starts are all one: the wandering ends before its last step."""
    size = np.geomspace(1e-9, 1e30, 40)
    p = ehrlich_aberth.polynomial(Rows.of(np.eye(40)), [size, np.zeros(40), np.ones(40)])
    taken = []
    eliminate = ehrlich_aberth.eliminate
    monkeypatch.setattr(ehrlich_aberth, "eliminate", lambda *given: taken.append(1) or eliminate(*given))
    monkeypatch.setattr(ehrlich_aberth, "MAX_WORK", 3000)
    wrong, all_of_them = np.ones(80, dtype=complex), np.ones(80, dtype=bool)
    assert not ehrlich_aberth.refine_roots(p, wrong, all_of_them, 0, np.full(80, 1e-2))[1]
    assert len(taken) <= 2 * 3000 // (p.operations + len(p.entries))
