"""Errors expected of uncertain points: two perturbed solutions where these agree well, four where they do not."""

import numpy as np
import pytest

from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.solve.responses.uncertain import PERTURBATION, expected_errors


def test_further_solutions_only_of_points_that_are_not_sure():
    asked = []

    def evaluate(kappa, other_order):
        """Receptances 1/k, the last one with a cancellation of a million."""
        k = kappa.by_law[0]
        asked.append((kappa.omega.tolist(), other_order))
        sensitive = kappa.omega == 3.0
        return np.where(sensitive, k - (1 - 1e-6) * 7.0, k)[:, None, None]

    omega = np.array([1.0, 2.0, 3.0])
    kappa = LawStiffness(np.zeros((1, 1)), np.zeros((1, 1)), np.full((1, 1), 7.0), omega)
    values = evaluate(kappa, False)
    asked.clear()
    errors = expected_errors(evaluate, kappa, values)[:, 0, 0]
    assert asked == [(omega.tolist(), False), (omega.tolist(), True), ([3.0], False), ([3.0], True)]
    assert errors[:2] == pytest.approx(0.75 * PERTURBATION, rel=0.4)
    assert errors[2] == pytest.approx(0.75e6 * PERTURBATION, rel=0.4)
