"""Sobol indices against closed forms and against scipy's own estimates of the same values."""

import numpy as np
import pytest
import scipy
from support import campaigns

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.study.answers.sensitivity_answers import estimates_of, sobol_points

FIRST, TOTAL = np.array([0.31390519, 0.44241114, 0.0]), np.array([0.55758886, 0.44241114, 0.24368366])


def ishigami(unit):
    x = np.pi * (2 * unit - 1)
    return np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


def sobol_estimates(function, n_parameters, base, seed):
    return estimates_of(function(sobol_points(n_parameters, base, seed)), base, seed, 0.95)


def within(found):
    first = (found.first_low <= FIRST) & (found.first_high >= FIRST)
    return np.concatenate([first, (found.total_low <= TOTAL) & (found.total_high >= TOTAL)])


def test_ishigami_within_its_intervals():
    found = sobol_estimates(ishigami, 3, 4096, seed=1)
    assert within(found).all()
    assert found.first == pytest.approx(FIRST, abs=0.02)
    assert found.total == pytest.approx(TOTAL, abs=0.02)
    assert found.variance == pytest.approx(7**2 / 8 + 0.1 * np.pi**4 / 5 + 0.1**2 * np.pi**8 / 18 + 0.5, rel=0.02)
    assert found.evaluations == 5 * 4096


@pytest.mark.slow
def test_intervals_hold_the_truth_as_often_as_they_say():
    seeds = campaigns.examples(10, 200)
    held = np.mean([within(sobol_estimates(ishigami, 3, 1024, seed=seed)) for seed in range(seeds)], axis=0)
    least = 0.95 - 3 * np.sqrt(0.95 * 0.05 / seeds)
    assert (held >= least).all()


def test_estimates_are_those_of_scipy():
    """The same halves, the same values: nothing but the interval is of this package's own making."""
    found = sobol_estimates(ishigami, 3, 256, seed=7)
    pair = scipy.stats.qmc.Sobol(6, rng=np.random.default_rng(7)).random(256)
    a, b = pair[:, :3], pair[:, 3:]
    mixed = [np.where(np.arange(3) == column, b, a) for column in range(3)]
    given = {"f_A": ishigami(a)[None], "f_B": ishigami(b)[None], "f_AB": np.array([ishigami(m)[None] for m in mixed])}
    other = scipy.stats.sobol_indices(func=given, n=256)
    assert found.first == pytest.approx(other.first_order.ravel(), rel=1e-9, abs=1e-12)
    assert found.total == pytest.approx(other.total_order.ravel(), rel=1e-9)


def test_no_index_is_beyond_a_share():
    """Of x_1 with hardly any of the others: indices of 1 and nearly 0, whose estimates scatter to both sides."""
    found = [sobol_estimates(lambda x: x[:, 0] + 0.01 * x[:, 1], 3, 64, seed=seed) for seed in range(5)]
    for name in ("first", "first_low", "first_high", "total", "total_low", "total_high"):
        shares = np.array([getattr(one, name) for one in found])
        assert ((shares >= 0) & (shares <= 1)).all(), name
    assert all((one.first_low <= one.first).all() and (one.first <= one.first_high).all() for one in found)
    truth = 1 / (1 + 0.01**2)
    assert all(one.first_low[0] <= truth <= one.first_high[0] for one in found)


def test_same_seed_same_bytes():
    one, same, other = (sobol_estimates(ishigami, 3, 128, seed=seed) for seed in (5, 5, 6))
    for name in ("first", "first_low", "first_high", "total", "total_low", "total_high"):
        assert getattr(one, name).tobytes() == getattr(same, name).tobytes()
        assert getattr(one, name).tobytes() != getattr(other, name).tobytes()


def test_variants_without_a_value_are_left_out_and_counted():
    def lacking(unit):
        return np.where(unit[:, 0] > 0.99, np.nan, ishigami(unit))

    found = sobol_estimates(lacking, 3, 1024, seed=1)
    # Base points of whose variants one has x1 above 0.99: the A column or the B column.
    assert found.without_value == pytest.approx(1024 * (1 - 0.99**2), rel=0.3)
    assert np.isfinite(found.first).all()


def test_what_cannot_be_answered():
    with pytest.raises(UsageError, match=r"(?s)64.*100.*out-of-range"):
        sobol_estimates(ishigami, 3, 100, seed=1)
    with pytest.raises(SolveError, match="does not vary"):
        sobol_estimates(lambda unit: np.full(len(unit), 2.0), 3, 64, seed=1)
    with pytest.raises(SolveError, match=r"(?s)64.*no-solution"):
        sobol_estimates(lambda unit: np.full(len(unit), np.nan), 3, 64, seed=1)
