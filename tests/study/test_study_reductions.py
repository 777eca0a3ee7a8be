"""Sums and percentiles of values that come in parts, against numpy on all of them."""

from itertools import pairwise

import numpy as np
import pytest

from torsionnet.study.reductions import summaries as histogram
from torsionnet.study.reductions.summaries import ACCURACY, Histogram, Moments

SHARES = [0.1, 2.5, 25, 50, 75, 97.5, 99.9]


def drawn(kind, count=20_000):
    rng = np.random.default_rng(3)
    return {
        "normal": rng.normal(size=(count, 3)),
        "tiny": rng.lognormal(-600, 3, size=(count, 2)),
        "huge": rng.lognormal(650, 3, size=(count, 2)),
        "steps": rng.integers(-3, 4, size=(count, 2)).astype(float),
        "narrow": 7 + 1e-3 * rng.normal(size=(count, 2)),
        "decades": np.sign(rng.normal(size=(count, 2))) * 10 ** rng.uniform(-300, 300, size=(count, 2)),
    }[kind]


@pytest.mark.parametrize("kind", ["normal", "tiny", "huge", "steps", "narrow", "decades"])
@pytest.mark.parametrize("most", [0, histogram.MOST_COUNTERS])
def test_percentiles_within_the_stated_accuracy(monkeypatch, kind, most):
    monkeypatch.setattr(histogram, "MOST_COUNTERS", most)
    values = drawn(kind)
    found = Histogram.of(values).percentiles(SHARES, values.shape[1])
    expected = np.percentile(values, SHARES, axis=0, method="inverted_cdf")
    assert (np.abs(found - expected) <= ACCURACY * np.abs(expected) * (1 + 1e-9)).all()


def test_parts_in_any_order_are_the_whole():
    values = drawn("normal")
    values[::7] = np.nan
    parts = [Histogram.of(part) for part in np.array_split(values, 13)]
    whole = Histogram.of(values)
    for order in (range(13), reversed(range(13))):
        joined = Histogram.joined([parts[n] for n in order])
        np.testing.assert_array_equal(joined.bins, whole.bins)
        np.testing.assert_array_equal(joined.counts, whole.counts)
    assert whole.counts.sum() == np.isfinite(values).sum()


def test_nothing_to_count():
    nothing = Histogram.of(np.full((5, 2), np.nan))
    assert np.isnan(nothing.percentiles([50], 2)).all()
    assert len(Histogram.joined([]).bins) == len(Histogram.joined([nothing, nothing]).bins) == 0


def test_moments_of_parts():
    values = drawn("narrow")
    values[3:5, 0], values[10] = np.nan, np.inf
    starts = [0, 1, 500, 501, 15_000, 20_000]
    parts = [Moments.of(values[a:b], a) for a, b in pairwise(starts)]
    whole = parts[0]
    for part in parts[1:]:
        whole = whole.joined(part)
    known = np.where(np.isfinite(values), values, np.nan)
    np.testing.assert_array_equal(whole.count, np.isfinite(values).sum(axis=0))
    np.testing.assert_allclose(whole.mean, np.nanmean(known, axis=0), rtol=1e-14)
    np.testing.assert_allclose(whole.deviation, np.nanstd(known, axis=0, ddof=1), rtol=1e-9)
    assert whole.smallest_at.tolist() == np.nanargmin(known, axis=0).tolist()
    assert whole.largest_at.tolist() == np.nanargmax(known, axis=0).tolist()
    assert whole.largest.tolist() == np.nanmax(known, axis=0).tolist()


@pytest.mark.parametrize("cuts", [[0, 6], [0, 1, 6], [0, 3, 6], [0, 1, 2, 3, 4, 5, 6]])
def test_extremes_are_those_of_the_first_of_several_equal_variants(cuts):
    values = np.array([[np.nan], [2.0], [1.0], [2.0], [1.0], [1.5]])
    whole, *others = (Moments.of(values[a:b], a) for a, b in pairwise(cuts))
    for part in others:
        whole = whole.joined(part)
    assert (whole.smallest[0], whole.smallest_at[0]) == (1.0, 2)
    assert (whole.largest[0], whole.largest_at[0]) == (2.0, 1)


@pytest.mark.filterwarnings("error")
def test_values_whose_squares_are_no_doubles_have_an_infinite_spread():
    found = Moments.of(np.array([[1e200, 1.0], [-1e200, 2.0], [3e200, 3.0]]), 0)
    assert found.mean == pytest.approx([1e200, 2.0])
    assert found.deviation.tolist() == [np.inf, 1.0]


def test_moments_of_nothing():
    nothing = Moments.of(np.full((4, 1), np.nan), 0)
    assert (nothing.count[0], nothing.largest_at[0]) == (0, -1)
    assert np.isnan(nothing.joined(nothing).deviation[0])
    some = Moments.of(np.array([[2.0], [4.0]]), 4)
    for joined in (nothing.joined(some),):
        assert (joined.mean[0], joined.smallest_at[0], joined.largest_at[0]) == (3.0, 4, 5)
