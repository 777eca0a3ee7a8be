"""Drivetrains of matrices M, C and K that were calculated elsewhere."""

import numpy as np
import pytest
from support.faults import faults_of

import torsionnet as tn


def eigenvalues(M, C, K):
    """Poles with Im >= 0 of M s^2 + C s + K by scipy's eigenvalues of the first-order form."""
    from scipy import linalg as la

    n = len(M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-K, -C]])
    poles = la.eig(A, la.block_diag(np.eye(n), M), right=False)
    return np.sort_complex(poles[poles.imag >= -1e-9])


def positive(draw, n):
    """A full symmetric matrix without negative parts, which no springs between two nodes make."""
    factor = draw.normal(size=(n, n))
    return factor @ factor.T


@pytest.mark.parametrize("seed", range(4))
def test_full_matrices_keep_poles_and_responses(seed):
    draw = np.random.default_rng(seed)
    n = 4
    M, K = positive(draw, n) + np.eye(n), 1e4 * positive(draw, n)
    C = 3 * positive(draw, n)
    rig = tn.Drivetrain.from_matrices(M, C, K, names=["a", "b", "c", "d"], inputs={"T": {"torque": "c"}})
    found = rig.matrices()
    for ours, theirs in zip((found.M, found.C, found.K), (M, C, K), strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-12 * np.abs(theirs).max())
    np.testing.assert_allclose(np.sort_complex(rig.modes().eigenvalues), eigenvalues(M, C, K), rtol=1e-9)
    s = 2j * np.pi * 7
    H = rig.frequency_response(["a", "d"], "T", [7]).values[0, :, 0]
    np.testing.assert_allclose(H, np.linalg.solve(M * s * s + C * s + K, np.eye(n)[2])[[0, 3]], rtol=1e-10)


def test_a_free_line_turns_freely_whatever_its_sums_are_rounded_to():
    """Three discs; 0.1 + 0.2 is no 0.3 in binary, and the row sums to 5.6e-17 of a spring to ground."""
    K = np.array([[0.1, -0.1, 0], [-0.1, 0.1 + 0.2, -0.2], [0, -0.2, 0.2]])
    for factor in (1, 1e5):
        rig = tn.Drivetrain.from_matrices(np.diag([1, 2, 3]), None, factor * K)
        assert min(rig.modes().natural_frequencies) == 0
        assert [fault.message for fault in rig.check() if "turn freely" in fault.message]


def test_a_reduced_model_is_free_but_for_rounding():
    """Guyan's reduction K_mm - K_ms K_ss^-1 K_sm of a free line, calculated elsewhere, has zero sums but for rounding."""
    draw = np.random.default_rng(5)
    k = draw.uniform(1e3, 1e6, 9)
    whole = sum(k[i] * np.outer(row, row) for i, row in enumerate(np.diff(np.eye(10), axis=0)))
    kept, left = [0, 3, 6, 9], [1, 2, 4, 5, 7, 8]
    solved = np.linalg.solve(whole[np.ix_(left, left)], whole[np.ix_(left, kept)])
    K = whole[np.ix_(kept, kept)] - whole[np.ix_(kept, left)] @ solved
    T = np.vstack([np.eye(4), -solved])
    M = T.T @ np.diag(draw.uniform(0.1, 2, 10)[[*kept, *left]]) @ T
    rig = tn.Drivetrain.from_matrices(M, None, K)
    from scipy import linalg

    expected = np.sqrt(np.maximum(linalg.eigh(K, M, eigvals_only=True), 0)) / (2 * np.pi)
    found = rig.modes().undamped_natural_frequencies
    np.testing.assert_allclose(np.sort(found)[1:], expected[1:], rtol=1e-9)
    assert min(found) < 1e-6


@pytest.mark.parametrize("ratio", [1 / 3, 0.7 / 1.1, 2.9, 1 / 7, 13 / 11, 0.123456789])
def test_a_spring_behind_a_gear_is_one_row(ratio):
    """k (theta_a + ratio theta_b)^2/2 has k, k ratio and k ratio^2, whose rounding is no second spring."""
    k = 0.7
    K = [[k, k * ratio], [k * ratio, k * ratio * ratio]]
    rig = tn.Drivetrain.from_matrices(np.eye(2), None, K)
    assert sum(bool(law.stiffness) for law in rig.assembly.laws) == 1
    assert min(rig.modes().natural_frequencies) == 0


def test_beside_other_elements_and_in_a_file(tmp_path):
    text = """
torsionnet: 1
name: crankshaft of another program
elements:
  crank: {type: lumped_matrices, nodes: [nose, wheel], inertia: [[0.5, 0], [0, 2 kg*m^2]], stiffness: [[9 kN*m/rad, -9e3], [-9e3, 9e3]]}
  gear: {type: gear, nodes: [wheel, out], ratio: 3}
  load: {type: inertia, node: out, inertia: 18}
"""
    path = tmp_path / "rig.yaml"
    path.write_text(text, encoding="utf-8")
    rig = tn.load(path)
    # 18 kg m^2 behind a ratio of 3 are 2 kg m^2 at the wheel.
    frequency = np.sqrt(9e3 * (1 / 0.5 + 1 / 4)) / (2 * np.pi)
    np.testing.assert_allclose(max(rig.modes().natural_frequencies), frequency, rtol=1e-12)
    assert not rig.check()[1:]  # nose is no dead end: its inertia is in the matrix
    rig.to_yaml(tmp_path / "again.yaml")
    assert tn.load(tmp_path / "again.yaml").elements["crank"] == rig.elements["crank"]


@pytest.mark.parametrize(
    ("K", "kind", "place"),
    [
        ([[1, 2], [3, 4]], "asymmetric-matrix", (1, 0)),
        ([[-1, 0], [0, 1]], "negative-law", (0, 0)),
        ([[1, 2], [2, 1]], "negative-law", (1,)),
        ([[0, 2], [2, 0]], "negative-law", (0,)),
        ([[1, -2], [-2, 1]], "negative-law", (1,)),
        ([[1, 2, 3], [2, 1]], "wrong-count", (0,)),
        ([[1]], "wrong-count", ()),
        ([["k", 1], [1, 2]], "expression-not-allowed", (0, 0)),
        ([["1 kg", 1], [1, 2]], "wrong-unit", (0, 0)),
        ("stiff", "wrong-form", ()),
        ([[float("nan"), 1], [1, 2]], "not-a-number", (0, 0)),
        ([[1, 1j], [1j, 2]], "not-a-number", ()),
    ],
)
def test_matrices_that_no_drivetrain_has(K, kind, place):
    found = faults_of(lambda: tn.Drivetrain.from_matrices(np.eye(2), None, K, names=["a", "b"]))
    assert found == [(kind, ("elements", "matrices", "stiffness", *place))]


def test_all_faults_at_once():
    with pytest.raises(tn.ModelError) as refused:
        tn.Drivetrain.from_matrices([[1, 2], [3, 4]], [[1, 0], [0, -2]], [[1]], names=["a", "b"])
    assert len(refused.value.faults) == 3
    with pytest.raises(tn.ModelError, match=r"elements\.matrices\.nodes\.0: .*repeated-name"):
        tn.Drivetrain.from_matrices(np.eye(2), names=["a", "a"])
    with pytest.raises(tn.ModelError, match=r"elements\.e\.inertia: .*missing-entry"):
        tn.LumpedMatrices("e", nodes=["a"])
    with pytest.raises(tn.ModelError, match=r"inertia: .*wrong-form"):
        tn.Drivetrain.from_matrices(np.array(2.0))


def test_a_nearly_symmetric_matrix_is_taken_as_its_mean():
    K = np.array([[3.0, -1 + 1e-13], [-1, 2]])
    found = tn.Drivetrain.from_matrices(np.eye(2), None, K).matrices().K
    np.testing.assert_allclose(found, [[3, -1], [-1, 2]], rtol=1e-12)


def test_complex_stiffness_becomes_damping_at_its_frequency():
    rig = tn.load("six_cylinder_diesel").configured("viscous_and_hysteretic")
    system, f = rig.matrices(at=40.0), 40.0
    assert system.K.imag.any()
    again = tn.Drivetrain.from_matrices(
        system.M, system.C + system.K.imag / (2 * np.pi * f), system.K.real, inputs={"T": {"torque": "q1"}}
    )
    found = again.frequency_response("q9", "T", [f]).values
    dynamic = -system.M * (2 * np.pi * f) ** 2 + 2j * np.pi * f * system.C + system.K
    np.testing.assert_allclose(found[0, 0, 0], np.linalg.inv(dynamic)[8, 0], rtol=1e-9)


def test_matrices_of_other_packages():
    import pandas as pd
    import scipy.sparse
    import sympy

    K = [[3, -1], [-1, 2]]
    for kind in (np.asarray, pd.DataFrame, sympy.Matrix, scipy.sparse.csr_array):
        assert tn.Drivetrain.from_matrices(kind(np.eye(2)), None, kind(K)).matrices().K.tolist() == K


def test_labels_of_data_frames_are_names():
    import pandas as pd

    K = pd.DataFrame([[3, -1], [-1, 2]], ["a", "b"], ["a", "b"])
    assert tn.Drivetrain.from_matrices(np.eye(2), None, K).nodes == ("a", "b")
    for names, M in ((["b", "a"], np.eye(2)), (None, K.loc[["b", "a"], ["b", "a"]])):
        found = faults_of(lambda names=names, M=M: tn.Drivetrain.from_matrices(M, None, K, names=names))
        assert found == 2 * [("contradicting-entries", ("elements", "matrices", "stiffness"))]


def test_dampers_resist_no_motion_that_springs_leave_free():
    """Of planetary stages, whose ratios make full rows, with the names of nodes inside a shaft."""
    system = tn.load("wind_turbine_3mw").configured("free").matrices()
    again = tn.Drivetrain.from_matrices(system.M, system.C, system.K, names=system.coordinates)
    expected = tn.load("wind_turbine_3mw").configured("free").modes().eigenvalues
    np.testing.assert_allclose(again.modes().eigenvalues, expected, rtol=1e-9)


@pytest.mark.parametrize(("n", "springs"), [(20, 19), (24, 24)])
def test_full_matrices_of_many_nodes(n, springs):
    """Every node coupled with every other, of which one motion is free, or none; small integers are quick to factor."""
    Q = np.random.default_rng(n).integers(-3, 4, size=(springs, n)).astype(float)
    found = tn.Drivetrain.from_matrices(np.eye(n), None, Q.T @ Q).modes().eigenvalues
    np.testing.assert_allclose(np.abs(found)[n - springs :], np.linalg.svd(Q)[1][::-1], rtol=1e-9)
    assert not found[: n - springs].any()
