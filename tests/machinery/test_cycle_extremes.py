"""Extremes of sums of orders over a cycle, against a grid so fine that its step no longer matters, and closed forms."""

import numpy as np
import pytest

from torsionnet.machinery.orders import synthesis as module
from torsionnet.machinery.orders.synthesis import cycle_extremes


def on_a_grid(amplitudes, periods, points=200_001):
    angle = 2 * np.pi * np.arange(points) / points
    waves = np.einsum("slo,lp->sop", amplitudes, np.exp(1j * np.outer(periods, angle))).real
    return np.array([waves.max(axis=2), waves.min(axis=2)])


@pytest.mark.parametrize(
    "periods",
    [
        [1, 2, 3, 4, 5, 6, 7, 8],
        [4, 8],
        [3, 3, 6],
        [0, 2, 4],
        [0, 21, 50],
        [1],
        [0],
        [7, 11, 13],
        [1, 40, 41],
        [90, 100, 110, 120],
        [25, 50, 75, 84, 168],  # two families, of 25 and 84 repetitions
        [24, 48, 85],
    ],
    ids=str,
)
@pytest.mark.parametrize("seed", range(3))
def test_any_sum(periods, seed):
    rng = np.random.default_rng([seed, len(periods)])
    amplitudes = rng.normal(size=(2, len(periods), 3)) + 1j * rng.normal(size=(2, len(periods), 3))
    # A step of 2 pi/200001 loses at most (c step)^2/8 of an amplitude.
    lost = (np.abs(amplitudes) * (np.square(periods) * (np.pi / 200_001) ** 2 / 2)[:, None]).sum(axis=1).max()
    found = cycle_extremes(amplitudes, periods)
    expected = on_a_grid(amplitudes, periods)
    assert found == pytest.approx(expected, abs=1.01 * lost + 1e-12)
    assert (found[0] >= expected[0] - 1e-12).all()
    assert (found[1] <= expected[1] + 1e-12).all()


@pytest.mark.parametrize("share", [0.0, 0.2, 0.24, 0.25, 0.26, 0.4])
def test_flat_and_split_maxima(share):
    """cos(phi) - a cos(2 phi) has one maximum of 1 - a up to a = 1/4, where it is flat, and two of a + 1/(8 a) beyond."""
    found = cycle_extremes(np.array([[[1.0], [-share]]], dtype=complex), [1, 2])
    highest = 1 - share if share <= 0.25 else share + 1 / (8 * share)
    assert found.ravel() == pytest.approx([highest, -1 - share], rel=1e-8)


def test_equal_waves_many_times_in_a_cycle_are_searched_once(monkeypatch):
    sizes = []
    monkeypatch.setattr(module, "waveforms", lambda _, n: sizes.append(n) or np.ones((1, 1, n)))
    cycle_extremes(np.ones((1, 2, 1), dtype=complex), [300, 600])
    assert sizes == [2 * module.COARSE_POINTS_PER_PERIOD]


def test_maxima_that_cannot_be_the_highest_are_not_refined(monkeypatch):
    """cos(2 phi) + 0.15 cos(phi) has tops of 1.15 and 0.85; between points pi/8 apart it rises by at most 0.08."""
    sizes, tops = [], module._tops
    monkeypatch.setattr(module, "_tops", lambda part, *given: sizes.append(len(part)) or tops(part, *given))
    highest, _ = cycle_extremes(np.array([[[0.15], [1.0]]], dtype=complex), [1, 2]).ravel()
    assert highest == pytest.approx(1.15, rel=1e-12)
    assert sizes[0] == 1


def test_beats_with_thousands_of_maxima(monkeypatch):
    monkeypatch.setattr(module, "MOST_MAXIMA", 100)
    found = cycle_extremes(np.array([[[1.0], [1j]]]), [1500, 1501])
    assert found.ravel() == pytest.approx([2, -2], rel=1e-6)


def test_no_speeds():
    assert cycle_extremes(np.zeros((0, 2, 3), dtype=complex), [1, 2]).shape == (2, 0, 3)


def test_outputs_that_nothing_excites_are_not_refined(monkeypatch):
    """cos 2 phi + 0.5 cos 4 phi is 1.5 at 0 and -0.75 at cos 2 phi = -1/2; a flat wave is zero all along its cycle."""
    refined = []
    tops = module._tops

    def counted(amplitudes, *others):
        refined.append(np.abs(amplitudes).sum(axis=1).min())
        return tops(amplitudes, *others)

    monkeypatch.setattr(module, "_tops", counted)
    waves = np.zeros((3, 2, 4), complex)
    waves[:, :, 1] = [1, 0.5]
    assert cycle_extremes(waves, [2, 4])[:, :, 1] == pytest.approx(np.array([[1.5] * 3, [-0.75] * 3]), rel=1e-9)
    assert not cycle_extremes(waves, [2, 4])[:, :, [0, 2, 3]].any()
    assert min(refined) > 0
