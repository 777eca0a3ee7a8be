"""Errors expected of uncertain points: two perturbed solutions where these agree well, four where they do not."""

import numpy as np
import pytest

from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.responses.transfer import PERTURBATION, expected_errors


def test_further_solutions_only_of_points_that_are_not_sure():
    asked = []

    def evaluate(kappa, other_order):
        """Receptances 1/k, the last one with a cancellation of a million."""
        k = kappa.by_law[0]
        omega = kappa.omega.ravel()
        asked.append((omega.tolist(), other_order))
        sensitive = omega == 3.0
        return np.where(sensitive, k - (1 - 1e-6) * 7.0, k)[:, None, None]

    omega = np.array([1.0, 2.0, 3.0])
    kappa = LawStiffness(np.zeros((1, 1)), np.zeros((1, 1)), np.full((1, 1), 7.0), omega)
    values = evaluate(kappa, False)
    asked.clear()
    errors = expected_errors(evaluate, kappa, values, 0 * values.real)[:, 0, 0]
    assert asked == [(omega.tolist(), False), (omega.tolist(), True), ([3.0], False), ([3.0], True)]
    assert errors[:2] == pytest.approx(0.75 * PERTURBATION, rel=0.4)
    assert errors[2] == pytest.approx(0.75e6 * PERTURBATION, rel=0.4)


def test_stiffnesses_are_perturbed_up_and_down():
    """By half the perturbation to all of it."""
    moved = []

    def evaluate(kappa, _):
        moved.append(kappa.by_law[:, 0].real / 7.0 - 1)
        return kappa.by_law[:1].T[:, None]

    nothing = np.zeros((1, 200))
    expected_errors(
        evaluate,
        LawStiffness(nothing, nothing, nothing + 7.0, np.ones(1)),
        np.full((1, 1, 1), 7.0 + 0j),
        np.zeros((1, 1, 1)),
    )
    shares = np.concatenate(moved) / PERTURBATION
    assert 0.4 < np.mean(shares > 0) < 0.6
    assert 0.49 < np.abs(shares).min() < np.abs(shares).max() < 1.01


def test_no_error_is_smaller_than_that_told_by_single_precision():
    """A share next to 1 may fall on the same side in all solutions; what is beyond that precision says nothing."""
    nothing = np.zeros((1, 1))
    kappa = LawStiffness(nothing, nothing, np.full((1, 1), 7.0), np.arange(1.0, 4.0))
    values = np.full((3, 1, 1), 1.5 + 0j)
    rounding = np.array([1e-16, 1e-7, np.inf]).reshape(3, 1, 1)
    errors = expected_errors(lambda laws, _: np.full((laws.n_points, 1, 1), 1.5 + 0j), kappa, values, rounding)
    assert errors.ravel().tolist() == [1e-16, 1e-7, 0.0]
