"""Shares, worst cases, swings, rank correlations and maps against closed forms and second methods."""

import numpy as np
import pytest
import scipy
from support import campaigns

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.study.answers.map_and_scatter import parameter_map, rank_correlations
from torsionnet.study.answers.sensitivity_answers import one_at_a_time
from torsionnet.study.answers.subset_sampling import counted_share
from torsionnet.study.answers.worst_case_answer import largest


@pytest.mark.parametrize(("hits", "count"), [(0, 50), (1, 1000), (31, 1000), (500, 1000), (1000, 1000)])
@pytest.mark.parametrize("confidence", [0.9, 0.95, 0.999])
def test_shares_have_the_exact_interval(hits, count, confidence):
    found = counted_share(hits, count, confidence)
    exact = scipy.stats.binomtest(hits, count).proportion_ci(confidence, method="exact")
    assert (found.low, found.high) == pytest.approx((exact.low, exact.high), rel=1e-9, abs=1e-15)
    assert found.value == hits / count


def test_shares_are_told_with_the_digits_they_have():
    assert counted_share(31_000, 1_000_000).percent == "3.10 % (3.07 to 3.13 %)"
    assert counted_share(0, 1000).percent == "0.0 % (0.0 to 0.4 %)"
    with pytest.raises(UsageError, match="got 5 of 4"):
        counted_share(5, 4)


def rippled(points):
    """Many maxima; the largest at 0.568359375 for every parameter."""
    x = 10.24 * points - 5.82
    return -(10 * x.shape[1] + (x**2 - 10 * np.cos(2 * np.pi * x)).sum(axis=1))


def saddle(points):
    return 4 * (points[:, 0] - 0.3) * (points[:, 1] - 0.6) - (points[:, 2] - 0.25) ** 2


@pytest.mark.parametrize("d", [1, 2, 4])
def test_the_largest_of_many_maxima(d):
    found = largest(rippled, d, seed=1)
    assert found.value == pytest.approx(0, abs=1e-9)
    assert found.point == pytest.approx(np.full(d, 5.82 / 10.24), abs=1e-5)
    assert found.at_lower == found.at_upper == ()


def test_bounds_that_hold_the_worst_case():
    found = largest(saddle, 3, seed=1)
    assert found.value == pytest.approx(4 * 0.7 * 0.4, rel=1e-12)
    assert (found.at_lower, found.at_upper) == ((), (0, 1))
    assert found.point[2] == pytest.approx(0.25, abs=1e-4)
    below = largest(lambda points: -saddle(points), 3, seed=1)
    assert below.value == pytest.approx(4 * 0.7 * 0.6 + 0.75**2, rel=1e-12)
    assert (below.at_lower, below.at_upper) == ((1,), (0, 2))


@pytest.mark.slow
def test_corners_of_many_parameters():
    """More corners (2^40) than can be tried: bound by bound."""
    signs = np.where(np.arange(40) % 3, 1.0, -2.0)
    found = largest(lambda points: points @ signs, 40, seed=1, tried=2000)
    assert found.value == pytest.approx(signs[signs > 0].sum(), rel=1e-12)


def test_kinks_do_not_stop_the_search():
    found = largest(lambda points: -np.abs(points - 0.3).max(axis=1), 4, seed=1)
    assert found.value == pytest.approx(0, abs=1e-4)


def test_random_points_find_none_worse():
    count = campaigns.examples(100_000, 1_000_000)
    found = largest(saddle, 3, seed=3)
    assert saddle(np.random.default_rng(9).random((count, 3))).max() <= found.value
    assert found.best_at_random <= found.value
    assert found.tried_at_random == 10_000


def test_a_random_point_that_is_better_is_followed(monkeypatch):
    """A search that looks nowhere else still ends at what random points found."""
    monkeypatch.setattr("torsionnet.study.answers.worst_case_answer.GENERATIONS", 1)
    found = largest(rippled, 2, seed=2)
    assert found.value == pytest.approx(0, abs=1e-6)


def test_points_without_a_value_are_passed_over():
    found = largest(lambda points: np.where(points[:, 0] > 0.5, np.nan, points[:, 0]), 2, seed=1)
    assert found.value == pytest.approx(0.5, abs=1e-6)
    with pytest.raises(SolveError, match="none of the corners"):
        largest(lambda points: np.full(len(points), np.nan), 2, seed=1)


def test_same_seed_same_worst_case():
    one, same = (largest(rippled, 2, seed=4) for _ in range(2))
    assert one.point.tobytes() == same.point.tobytes()
    assert one.evaluations == same.evaluations


def test_swings_of_one_parameter_at_a_time():
    def product(points):
        return points[:, 0] * points[:, 1] ** 2

    found = one_at_a_time(product, np.array([2.0, 3.0]), np.array([1.0, 2.0]), np.array([3.0, 4.0]))
    assert found.middle == 18
    assert found.at_low.tolist() == [9, 8]
    assert found.at_high.tolist() == [27, 32]
    assert found.order == [1, 0]


def test_rank_correlations_are_those_of_scipy():
    numbers = np.random.default_rng(1)
    parameters = numbers.standard_normal((200, 3))
    values = np.exp(parameters[:, 0]) + parameters[:, 1]
    values[::20] = np.nan
    found = rank_correlations(parameters, values)
    known = np.isfinite(values)
    for column, coefficient in zip(parameters[known].T, found.coefficients, strict=True):
        assert coefficient == pytest.approx(scipy.stats.spearmanr(column, values[known]).statistic, abs=1e-12)
    assert found.count == 190
    assert (found.low < found.coefficients).all()
    assert (found.coefficients < found.high).all()
    still = rank_correlations(np.zeros((20, 1)), np.arange(20.0))
    assert np.isnan(still.coefficients).all()
    with pytest.raises(SolveError, match="no-solution"):
        rank_correlations(np.zeros((3, 1)), np.arange(3.0))


def test_maps_over_two_parameters():
    def frequency(values):
        return np.sqrt(values["k"] / values["J"]) + values["c"]

    k, J = np.array([1.0, 4.0, 9.0]), np.array([1.0, 4.0])
    found = parameter_map(frequency, ("k", k), ("J", J), {"c": np.array([0.0, 1.0])})
    assert found.values == pytest.approx(np.sqrt(k[:, None] / J) + 0.5)
    assert found.where(largest=True) == (9.0, 1.0, 3.5)
    assert found.where(largest=False) == (1.0, 4.0, 1.0)
    lowest = parameter_map(frequency, ("k", k), ("J", J), {"c": np.array([0.0, 1.0])}, "smallest")
    assert lowest.values == pytest.approx(np.sqrt(k[:, None] / J))
