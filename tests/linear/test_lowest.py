"""The lowest modes of large systems: sparse routes against the dense ones, and against closed forms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import campaigns

import torsionnet as tn
from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import Rows, RowSystem
from torsionnet.linear.dynamic_stiffness.row_algebra import null_space
from torsionnet.linear.modes import eigen
from torsionnet.linear.modes.eigen import complex_modes, undamped_modes
from torsionnet.linear.modes.pencil import Pencil


def tree(seed, n, *, damped=True, geared=True, branched=True, massless=0, ground=0, loops=0, drag=False):
    """Random inertias 0.1..10, springs 1e4..1e6, light dampers; ``ground`` springs, ``loops`` more springs."""
    rng = np.random.default_rng(seed)
    inertia = 10 ** rng.uniform(-1, 1, n)
    inertia[rng.choice(n, massless, replace=False)] = 0
    pairs = [(int(rng.integers(max(0, i - 5), i)) if branched else i - 1, i) for i in range(1, n)]
    pairs += [tuple(sorted(rng.choice(n, 2, replace=False))) for _ in range(loops)]
    rows, J, c, k = [*np.eye(n)], [*inertia], [*(rng.uniform(0, 0.3, n) * drag)], [0.0] * n
    for i, j in pairs:
        row = np.zeros(n)
        row[i], row[j] = 1.0, -(rng.choice([1.0, 1.0, 2.0, -3.3, 0.4]) if geared and len(rows) < 2 * n - 1 else 1.0)
        rows.append(row)
        k.append(10 ** rng.uniform(4, 6))
        c.append(k[-1] * 10 ** rng.uniform(-6, -3) * damped)
        J.append(0.0)
    for i in rng.choice(n, ground, replace=False):
        k[i] = 10 ** rng.uniform(4, 6)
    return RowSystem(Rows.of(np.array(rows)), np.array(J), np.array(c) * damped, np.array(k))


@pytest.fixture
def sparse_only(monkeypatch):
    """Make the dense routes fail, so that the test sees what the sparse ones find."""

    def fail(*_):
        raise AssertionError("a dense route was taken")

    return lambda: monkeypatch.setattr(eigen, "subspaces", fail)


def same(few, every, count):
    assert few.kinds == every.kinds[:count]
    np.testing.assert_allclose(few.eigenvalues, every.eigenvalues[:count], rtol=1e-9, atol=1e-300)
    likeness = np.abs(np.sum(few.vectors.conj() * every.vectors[:, :count], axis=0))
    likeness /= np.linalg.norm(few.vectors, axis=0) * np.linalg.norm(every.vectors[:, :count], axis=0)
    np.testing.assert_allclose(likeness, 1, rtol=1e-6)


CASES = {
    "chain": {"geared": False, "branched": False},
    "chain of 300": {"n": 300, "geared": False, "branched": False},
    "undamped chain": {"geared": False, "branched": False, "damped": False},
    "chain with drag": {"geared": False, "branched": False, "drag": True},
    "clamped": {"branched": False, "geared": False, "ground": 3},
    "geared tree": {"n": 120},
    "undamped geared tree": {"n": 120, "damped": False},
    "massless nodes": {"n": 90, "massless": 20},
    "undamped massless nodes": {"n": 90, "massless": 20, "damped": False},
    "loops, on the ground": {"n": 100, "loops": 3, "ground": 1, "geared": False},
    "loops, undamped": {"n": 100, "loops": 3, "geared": False, "damped": False},
}


@pytest.mark.few(1, 5)
@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.nightly)])
def test_lowest_modes_are_the_dense_ones(case, seed, sparse_only):
    system = tree(seed, **{"n": 80, **case})
    every, natural = complex_modes(system), undamped_modes(system)[0]
    sparse_only()
    same(complex_modes(system, 12), every, 12)
    omega, shapes = undamped_modes(system, 12)
    np.testing.assert_allclose(omega, natural[:12], rtol=1e-9)
    assert shapes.shape == (system.n_coordinates, 12)


@pytest.mark.slow
@settings(max_examples=campaigns.examples(5, 25), deadline=None)
@given(seed=st.integers(0, 10**6), damped=st.booleans(), drag=st.booleans(), massless=st.integers(0, 15))
def test_any_tree(seed, damped, drag, massless):
    system = tree(seed, 80, damped=damped, drag=drag, massless=massless, ground=seed % 2)
    few, every = complex_modes(system, 10), complex_modes(system)
    assert few.kinds == every.kinds[:10]
    np.testing.assert_allclose(few.eigenvalues, every.eigenvalues[:10], rtol=1e-8, atol=1e-300)


@pytest.mark.parametrize("damping", [0.0, 1e-4])
def test_identical_branches_keep_all_their_modes(damping, sparse_only):
    """Five equal chains on one hub: every mode in which the hub rests comes four times."""
    branches, length = 5, 20
    n = 1 + branches * length
    rows, k = [*np.eye(n)], [0.0] * n
    for i in range(1, n):
        row = np.zeros(n)
        row[i], row[i - 1 if (i - 1) % length else 0] = 1.0, -1.0
        rows.append(row)
        k.append(1e5)
    k, link = np.array(k), np.arange(len(rows)) >= n
    system = RowSystem(Rows.of(np.array(rows)), 1.0 * ~link, damping * k, k)
    sparse_only()
    found = complex_modes(system, 11)
    clamped = 2 * np.sqrt(1e5) * np.sin(np.pi * (2 * np.arange(1, 4) - 1) / (4 * length + 2))
    for omega in clamped[:2]:
        size = np.abs(found.eigenvalues)
        multiple = np.abs(size - omega) < 1e-9 * omega
        assert multiple.sum() == branches - 1
        assert np.linalg.matrix_rank(found.vectors[:, multiple], tol=1e-6) == branches - 1


@pytest.mark.slow
def test_chain_in_closed_form(sparse_only):
    """Free chain of equal parts: omega_m = 2 sqrt(k/J) sin(m pi / 2n), damping proportional to stiffness."""
    n, k, beta = 400, 1e6, 1e-5
    rows = np.vstack([np.eye(n), np.eye(n)[1:] - np.eye(n)[:-1]])
    link = np.arange(len(rows)) >= n
    system = RowSystem(Rows.of(rows), 1.0 * ~link, beta * k * link, k * link)
    sparse_only()
    omega = 2 * np.sqrt(k) * np.sin(np.arange(20) * np.pi / (2 * n))
    np.testing.assert_allclose(np.abs(complex_modes(system, 20).eigenvalues), omega, rtol=1e-12)
    np.testing.assert_allclose(complex_modes(system, 20).eigenvalues.real, -beta * omega**2 / 2, rtol=1e-9)
    np.testing.assert_allclose(undamped_modes(system, 20)[0], omega, rtol=1e-12)


@pytest.mark.slow
def test_slow_real_poles_come_first():
    """Heavy drag to ground makes poles slower than every vibration."""
    n = 50
    system = tree(3, n, geared=False, branched=False, ground=1)
    damping = np.array(system.damping)
    damping[:n] = 1e4
    heavy = RowSystem(system.law_rows, system.inertia, damping, system.stiffness)
    every = complex_modes(heavy)
    assert every.kinds[0] == "real pole"
    few = complex_modes(heavy, 8)
    np.testing.assert_allclose(few.eigenvalues, every.eigenvalues[:8], rtol=1e-8)


def test_graded_chain_is_left_to_the_dense_route():
    """Ratios multiply along this chain: its slowest mode has 1e-7 rad/s, the next one 2 rad/s."""
    system = tree(1, 80, branched=False, ground=3)
    same(complex_modes(system, 6), complex_modes(system), 6)


def test_rigid_bodies_alone():
    system = tree(1, 80)
    assert complex_modes(system, 1).kinds == ("rigid body",)
    assert undamped_modes(system, 1)[0].tolist() == [0.0]


def test_nothing_acting_is_still_refused():
    system = tree(1, 80)
    loose = RowSystem(
        Rows.of(np.hstack([system.rows, np.zeros((len(system.rows), 1))])),
        *(np.array(part) for part in (system.inertia, system.damping, system.stiffness)),
    )
    with pytest.raises(SolveError, match="indeterminate-motion"):
        complex_modes(loose, 5)


@pytest.mark.parametrize("seed", range(6))
def test_null_space_of_pairs_is_that_of_the_singular_values(seed):
    system = tree(seed, 90, loops=seed % 3, geared=seed % 2 == 0)
    springs = system.rows[system.stiffness > 0][: 40 + 15 * seed]
    basis = null_space(Rows.of(springs).maps, 90).basis()
    assert basis.shape[1] == 90 - np.linalg.matrix_rank(springs)
    np.testing.assert_allclose(springs @ basis, 0, atol=1e-13)
    np.testing.assert_allclose(basis.T @ basis, np.eye(basis.shape[1]), atol=1e-13)


def test_inconsistent_loop_of_ratios_holds_still():
    rows = np.zeros((80, 80))
    for i in range(80):
        rows[i, i], rows[i, (i + 1) % 80] = 1.0, -2.0 if i == 5 else -1.0
    assert null_space(Rows.of(rows).maps, 80).dimension == 0
    rows[5, 6] = -1.0
    np.testing.assert_allclose(null_space(Rows.of(rows).maps, 80).basis()[:, 0], 80**-0.5)


def test_wide_row_that_cancels_in_parts_that_turn_as_one_holds_nothing():
    tied = [{0: 1.0, 1: -1.0}, {1: 1.0, 2: -1.0}]
    for wide in ({0: 0.1, 1: 0.2, 2: -0.3}, {0: 0.5, 1: 0.5, 2: -1.0}):  # to 6e-17, and to nothing
        beside = {2: 1.0, 3: 1.0, 4: -2.0}
        assert null_space([wide, *tied], 3).columns == ({0: 1.0, 1: 1.0, 2: 1.0},)
        assert null_space([wide, *tied, beside], 5).dimension == 2


def test_result_with_lowest_is_the_start_of_the_whole():
    rig = tn.load("amt_rig").configured("V")
    whole, few = rig.modes(), rig.modes(lowest=2)
    assert len(few) == len(few.undamped_natural_frequencies[:2]) == 2
    assert few.descriptions == whole.descriptions[:2]
    np.testing.assert_array_equal(few.shapes, whole.shapes[:, :2])
    assert few.energy_shares(1) == whole.energy_shares(1)
    assert len(rig.modes(lowest=99)) == len(whole)


@pytest.mark.parametrize("count", [0, -1])
def test_lowest_must_ask_for_something(count):
    with pytest.raises(tn.UsageError, match="at least one"):
        tn.load("dmf_rig").modes(lowest=count)


def test_lowest_of_a_cut_system():
    rig = tn.load("dmf_rig")
    assert rig.modes(measured_input="T_T", lowest=1).eigenvalues == rig.modes(measured_input="T_T").eigenvalues[:1]


def test_large_drivetrain_has_the_same_words_and_energies(sparse_only):
    n = 90
    elements = [tn.Inertia(f"J{i}", node=f"n{i}", inertia=1 + i % 7) for i in range(n)]
    elements += [
        tn.Spring(f"k{i}", nodes=(f"n{i}", f"n{i + 1}"), stiffness=1e5 * (1 + i % 3), damping=5) for i in range(n - 1)
    ]
    rig = tn.Drivetrain("line", elements)
    whole = rig.modes()
    sparse_only()
    few = rig.modes(lowest=10)
    assert few.descriptions == whole.descriptions[:10]
    np.testing.assert_allclose(few.shapes, whole.shapes[:, :10], atol=1e-8)
    np.testing.assert_allclose(few.strain, whole.strain[:, :10], atol=1e-8)
    np.testing.assert_allclose(few.undamped_natural_frequencies, whole.undamped_natural_frequencies[:10], rtol=1e-9)


def test_equal_eigenvalues_stay_real_in_every_combination_of_their_shapes():
    """Three arms alike with k/J = .3/.7 against ground: rounding of eig moves the three off the axis."""
    rng = np.random.default_rng(1)
    system = RowSystem(Rows.of(np.eye(4)), np.array([0.7, 0.7, 0.7, 3.0]), np.zeros(4), np.array([0.3, 0.3, 0.3, 6.0]))
    pencil = Pencil.of(system, undamped=True)
    for _ in range(200):
        shapes = np.eye(4)[:, :3] / pencil.scale[:, None] @ rng.normal(size=(3, 3))
        steps, mixed = pencil.split(shapes, 0.3 / 0.7 * (1 + 1e-14))
        assert np.isrealobj(steps)
        assert np.abs(steps).max() < 1e-9
        assert np.linalg.matrix_rank(mixed) == 3
