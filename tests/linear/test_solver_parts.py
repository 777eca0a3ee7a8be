"""Small parts around the solvers, against closed forms: peaks, frequencies to ask for, blocks of a system in time."""

import numpy as np
import pytest
import scipy

from torsionnet.base.errors import UsageError
from torsionnet.linear.dynamic_stiffness.triangular import blocks
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.linear.modes.modes import Modes
from torsionnet.linear.responses.grid import Adaptive, inner_maxima, peaks, round_number, static_value, vibration_range

TURN = 2 * np.pi


def resonance(f0, zeta):
    """Second output of two, first input of two: one mode of unit static value."""

    def solve(f):
        f = np.asarray(f, dtype=float)
        values = np.ones((len(f), 2, 2), dtype=complex) / (1 + f[:, None, None])
        values[:, 1, 0] = 1 / (1 - (f / f0) ** 2 + 2j * zeta * f / f0)
        channels = (Channel("a", "rad"), Channel("b", "rad")), (Channel("T", "N*m"), Channel("U", "N*m"))
        return FrequencyResponse(f, values, *channels)

    return solve


class TestPeaks:
    @pytest.mark.parametrize("zeta", [0.002, 0.05, 0.3])
    @pytest.mark.parametrize("f0", [9.83, 10.0, 10.17])
    def test_are_found_far_more_finely_than_the_grid(self, f0, zeta):
        solve, apart = resonance(f0, zeta), 0.5
        (peak,) = peaks(solve(np.arange(1, 20, apart)), solve, 1, 0)
        assert peak.frequency == pytest.approx(f0 * np.sqrt(1 - 2 * zeta**2), abs=2 * apart / 40 * (2 / 40) ** 2)
        assert peak.magnitude == pytest.approx(1 / (2 * zeta * np.sqrt(1 - zeta**2)), rel=1e-2 if zeta < 0.01 else 1e-4)
        at = 1 / (1 - (peak.frequency / f0) ** 2 + 2j * zeta * peak.frequency / f0)
        assert peak.phase == pytest.approx(np.degrees(np.angle(at)), abs=1e-9)

    def test_the_ends_are_none(self):
        solve = resonance(10.0, 0.05)
        for f in (np.arange(1, 9.6, 0.5), np.arange(10, 20, 0.5)):
            assert list(peaks(solve(f), solve, 1, 0)) == []
        assert list(peaks(solve(np.arange(1, 20.0)), solve, 0, 1)) == []

    @pytest.mark.parametrize(
        ("values", "expected"),
        [([1, 2, 1], [1]), ([1, 2, 2, 1], [1]), ([2, 1, 2], []), ([1, 2, 3], []), ([0, 1, 0, 2, 0, 3, 0], [1, 3, 5])],
    )
    def test_inner_maxima(self, values, expected):
        assert inner_maxima(np.array(values, dtype=float)) == expected

    def test_static_value(self):
        assert static_value(resonance(5.0, 0.1), 1, 0) == 1

        def refuses(_):
            raise UsageError("no answer there")

        assert np.isnan(static_value(refuses, 0, 0))


def modes(*eigenvalues):
    count = len(eigenvalues)
    values = TURN * np.array(eigenvalues, dtype=complex)
    nothing = np.zeros((0, count))
    words = ("",) * count
    return Modes(values, words, (), nothing, np.zeros(0), (), nothing, nothing, nothing, np.ones(count, bool), words)


class TestAdaptive:
    @pytest.mark.parametrize(
        ("start", "stop", "expected"),
        [
            (0, 10, np.linspace(0, 10, 5)),
            (1.5, 10, np.linspace(1.5, 10, 5)),
            (1, 10, np.geomspace(1, 10, 5)),
            (1, 500, np.geomspace(1, 500, 5)),
        ],
    )
    def test_without_modes(self, start, stop, expected):
        np.testing.assert_allclose(Adaptive(start, stop, 5).frequencies(), expected, rtol=1e-12)

    def test_equal_steps_of_phase_around_a_mode(self):
        """f_d + zeta f_0 tan(phi), for eleven phases from -85 to 85 degrees; a real pole and a rigid body add nothing."""
        found = Adaptive(1, 9, 2, 11).frequencies(modes(0, -3, -0.03 + 5j))
        phase = np.radians(np.arange(-85, 86, 17))
        np.testing.assert_allclose(found, [1, *(5 + 0.03 * np.tan(phase)), 9], rtol=1e-12)

    def test_without_damping_a_millionth(self):
        found = Adaptive(1, 9, 2, 3).frequencies(modes(5j))
        np.testing.assert_allclose(found[1:4] - 5, 5e-6 * np.tan(np.radians(85)) * np.array([-1, 0, 1]), rtol=1e-6)

    def test_nothing_outside_of_the_range_and_nothing_twice(self):
        one = modes(-0.03 + 5j, -0.1 + 50j)
        found = Adaptive(5, 9, 2, 11).frequencies(one, modes((-0.03 + 5j) * (1 + 1e-12)))
        phase = np.radians(np.arange(17, 86, 17))
        np.testing.assert_allclose(found, [5, *(5 + 0.03 * np.tan(phase)), 9], rtol=1e-9)

    @pytest.mark.parametrize("wrong", [(-1, 5), (5, 5), (6, 5), (1, np.inf), (1, np.nan), (1, 5, 0), (1, 5, 10, 0)])
    def test_wrong(self, wrong):
        with pytest.raises(UsageError, match="unordered-rows"):
            Adaptive(*wrong)

    def test_least(self):
        assert len(Adaptive(0, 5, 1, 1).frequencies(modes(-0.1 + 3j))) == 2


class TestRange:
    @pytest.mark.parametrize(
        ("value", "down", "up"),
        [
            (1, 1, 1),
            (1.01, 1, 2),
            (2, 2, 2),
            (4.9, 2, 5),
            (5, 5, 5),
            (5.1, 5, 10),
            (0.03, 0.02, 0.05),
            (730, 500, 1000),
        ],
    )
    def test_round_numbers(self, value, down, up):
        assert round_number(value, up=False) == pytest.approx(down, rel=1e-12)
        assert round_number(value, up=True) == pytest.approx(up, rel=1e-12)

    def test_of_modes(self):
        """A tenth of the lowest, twice the highest of what vibrates: 0.42 and 320 here."""
        assert vibration_range(modes(0, -2, -1 + 7j), modes(4.2j, 160j)) == pytest.approx((0.2, 500))
        assert vibration_range(modes(0, -2)) == vibration_range() == (0.1, 100.0)


RNG = np.random.default_rng(1)
RIGID = np.zeros((4, 4))
RIGID[:2, 2:] = np.eye(2)
RIGID[2:, :2] = [[-9.0, 9.0], [3.0, -3.0]]
SYSTEMS = {
    "pairs and real poles": RNG.normal(size=(5, 5)),
    "free to turn": RIGID,
    "free to turn, with drag": RIGID - np.diag([0, 0, 0.5, 0.2]),
    "critical damping": np.array([[0.0, 1.0], [-4.0, -4.0]]),
    "critical, beside a pair": np.block([[np.array([[0, 1.0], [-4, -4]]), RNG.normal(size=(2, 2))], [np.zeros((2, 2)), np.array([[0, 1.0], [-9, -0.1]])]]),
    "at rest alone": np.array([[0.0, 1.0], [0.0, 0.0]]),
    "unlike sizes": np.array([[0.0, 1.0], [-1e8, -3.0]]),
    "one drives the next": np.array([[-1.0, 0, 0], [2.0, -3.0, 0], [4.0, 5.0, -6.0]]),
}  # fmt: skip


class TestBlocks:
    """The impulse response C exp(A t) B is the sum of that of the blocks."""

    @pytest.mark.parametrize("name", SYSTEMS)
    def test_impulse_response(self, name):
        A, rng = SYSTEMS[name], np.random.default_rng(2)
        B, C = rng.normal(size=(len(A), 2)), rng.normal(size=(3, len(A)))
        parts = blocks(A, B, C)
        period = 1 / max(1.0, np.abs(np.linalg.eigvals(A)).max())
        for t in (0.0, 0.3 * period, 2.0 * period):
            found = sum((part.C @ scipy.linalg.expm(part.T * t) @ part.B).real for part in parts)
            expected = C @ scipy.linalg.expm(A * t) @ B
            np.testing.assert_allclose(found, expected, atol=1e-8 * np.abs(expected).max())
        assert all(np.allclose(part.T, np.triu(part.T)) for part in parts)

    def test_of_each_pair_one_is_kept(self):
        A = np.array([[0, 1.0, 0], [-4.0, -0.2, 0], [0, 0, -7.0]])
        (part,) = blocks(A, np.ones((3, 1)), np.ones((1, 3)))
        assert part.is_diagonal
        poles = np.sort_complex(np.diag(part.T))
        np.testing.assert_allclose(poles, [-7, -0.1 + 1j * np.sqrt(4 - 0.01)], atol=1e-12)

    def test_rest_is_a_block_of_its_own(self):
        rest, swings = blocks(SYSTEMS["free to turn"], np.ones((4, 1)), np.ones((1, 4)))
        assert rest.T.shape == (2, 2)
        assert np.abs(np.diag(rest.T)).max() < 1e-6
        np.testing.assert_allclose(np.diag(swings.T), [1j * np.sqrt(12)], atol=1e-9)
        assert not rest.is_diagonal

    def test_critical_damping_stays_triangular(self):
        (part,) = blocks(SYSTEMS["critical damping"], np.ones((2, 1)), np.ones((1, 2)))
        assert not part.is_diagonal

    def test_of_nothing(self):
        assert blocks(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0))) == []
