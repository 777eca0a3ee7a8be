"""What a fit of modes is made of, piece by piece, against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from support.modal_cases import chain_residues, pole, response_of

from torsionnet.base.errors import UsageError
from torsionnet.modal import Settings, identify_modes
from torsionnet.modal.matrix_fraction import Order, _same, orthogonal, powers, roots
from torsionnet.modal.modal_estimate import line_spacing
from torsionnet.modal.mode_identification import fit_poles
from torsionnet.modal.refinement import factors_of
from torsionnet.modal.residues import Projection, expand
from torsionnet.modal.selection import BicCriterion, line_correlation, significant_poles
from torsionnet.modal.spectral_lines import Criteria, Lines, lines_of

LINES = np.arange(1.0, 20.01, 0.5)
POLES = np.array([pole(4, 0.03), -40.0 + 0j, pole(9, 0.05), -70.0 + 0j])


def lines(noise=0.0, outputs=2, inputs=2, **more):
    response = response_of(POLES, chain_residues(POLES, outputs, inputs)[0], LINES, noise=noise, **more)
    return lines_of(response, Settings())


class TestLines:
    VALUES = np.array([[[3.0, 1e-9]], [[4j, 2e-9]], [[0.0, 2e-9]], [[-5.0, 1e-9]]])

    def made(self, **more):
        response = response_of(POLES[:1], np.ones((1, 1, 2)), [1.0, 2.0, 3.0, 4.0])
        return lines_of(replace(response, values=self.VALUES, **more.pop("given", {})), Settings(**more))

    def test_balance_makes_every_root_mean_square_one(self):
        found = self.made().balance
        np.testing.assert_allclose(found, [[1 / np.sqrt(50 / 4), 1 / np.sqrt(10 / 4) / 1e-9]], rtol=1e-12)
        nothing = replace(self.made(), values=0 * self.VALUES)
        np.testing.assert_array_equal(nothing.balance, [[1.0, 1.0]])

    def test_uniform_weights(self):
        weights = self.made(weights="uniform").weights
        np.testing.assert_allclose(weights[:, 0, 0], 1 / np.sqrt(50 / 4), rtol=1e-12)
        np.testing.assert_allclose(weights[:, 0, 1], 1e9 / np.sqrt(10 / 4), rtol=1e-12)

    def test_relative_weights_have_a_floor(self):
        weights = self.made(weights="relative").weights
        np.testing.assert_allclose(weights[:, 0, 0], [1 / 3, 1 / 4, 1e6 / np.sqrt(50 / 4), 1 / 5], rtol=1e-12)

    def test_weights_of_coherence(self):
        """A coherence c leaves a share (1 - c) / c of the power to noise."""
        coherence = np.array([0.5, 0.9, 0.2, 1.0])[:, None, None] * np.ones((1, 1, 2))
        weights = self.made(weights="coherence", given={"coherence": coherence}).weights
        expected = np.array([1e9, 5e8, 5e8, 1e9]) * np.sqrt([1, 9, 0.25, (1 - 1e-6) / 1e-6])
        np.testing.assert_allclose(weights[:, 0, 1], expected, rtol=1e-9)

    def test_four_lines_are_enough(self):
        response = response_of(POLES[:1], np.ones((1, 1, 1)), np.arange(0.0, 5.0))
        assert lines_of(response, Settings()).s.tolist() == pytest.approx(2j * np.pi * np.arange(1, 5))
        assert len(lines_of(response, Settings(band=(1, 4))).s) == 4

    @pytest.mark.parametrize(
        ("frequencies", "band", "usable", "message"),
        [
            (4, None, None, "too-short"),
            (6, (1, 3), None, "too-short"),
            (6, None, 2.5, r"(?s)2\.5.*too-short"),
        ],
    )
    def test_too_few(self, frequencies, band, usable, message):
        response = response_of(POLES[:1], np.ones((1, 1, 1)), np.arange(float(frequencies)))
        with pytest.raises(UsageError, match=message):
            lines_of(replace(response, usable_up_to=usable), Settings(band=band))

    def test_usable_up_to_is_the_end_unless_a_band_is_given(self):
        response = replace(response_of(POLES[:1], np.ones((1, 1, 1)), np.arange(10.0)), usable_up_to=6.0)
        assert len(lines_of(response, Settings()).s) == 6
        assert len(lines_of(response, Settings(band=(0, 9))).s) == 9


class TestSettings:
    def test_criteria_by_default(self):
        assert Criteria() == Criteria(frequency=0.01, damping=0.05, shape=0.98)
        assert [Criteria().enough(orders) for orders in (8, 40, 49, 50, 60)] == [4, 4, 4, 5, 6]
        assert Criteria(least_orders=2).enough(60) == 2

    @pytest.mark.parametrize(
        "allowed", [{"highest_order": 1}, {"band": (0, 1)}, {"method": "lscf", "highest_order": 2}]
    )
    def test_allowed(self, allowed):
        assert Settings(**allowed)

    def test_order_by_default(self):
        orders = [Settings(method).order for method in ("rational", "lscf", "auto")]
        assert (orders, Settings(highest_order=3).order) == ([10, 40, 40], 3)


class TestPolynomials:
    @pytest.mark.parametrize("degree", [1, 6, 40])
    def test_orthonormal_and_their_recurrence(self, degree):
        rng = np.random.default_rng(1)
        s, weights = 1j * np.sort(rng.uniform(0.02, 1, 200)), rng.uniform(0.1, 3, 200)
        family = orthogonal(s, weights, degree)
        weighted = family.values * weights[:, None]
        np.testing.assert_allclose((weighted.conj().T @ weighted).real, np.eye(degree + 1), atol=1e-12)
        for k in range(degree):
            below = family.down[k] * family.values[:, k - 1] if k else 0.0
            expected = family.up[k] * family.values[:, k + 1] + below
            np.testing.assert_allclose(s * family.values[:, k], expected, atol=1e-9)

    def test_even_ones_are_real_and_odd_ones_imaginary(self):
        values = orthogonal(1j * np.linspace(0.1, 1, 30), np.ones(30), 3).values
        assert not values[:, ::2].imag.any()
        assert not values[:, 1::2].real.any()

    @pytest.mark.parametrize("size", [1, 2])
    @pytest.mark.parametrize("family", ["powers", "orthogonal"])
    def test_roots(self, size, family):
        """At a root the row times the matrix vanishes; every degree gives so many roots."""
        rng, degree = np.random.default_rng(2), 4
        coefficients = rng.normal(size=(degree + 1, size, size))
        at = 1j * np.linspace(0.1, 1, 50)
        chosen = powers(np.exp(at), degree) if family == "powers" else orthogonal(at, np.ones(50), degree)
        found, rows = roots(coefficients, chosen)
        assert found.shape == (degree * size,)
        for root, row in zip(found, rows, strict=True):
            values = [1.0 if family == "powers" else chosen.values[0, 0]]
            for k in range(degree):
                below = chosen.down[k] * values[k - 1] if k else 0.0
                values.append((root * values[k] - below) / chosen.up[k])
            matrix = np.tensordot(values, coefficients, axes=1)
            assert np.linalg.norm(row @ matrix) < 1e-9 * np.linalg.norm(row) * np.abs(matrix).max() + 1e-9


class TestProjection:
    """What a projection leaves over is what the best residues leave over."""

    @pytest.mark.parametrize("residuals", ["both", "lower", "upper", "none"])
    @pytest.mark.parametrize("output", ["rad", "rad/s^2"])
    def test_left_over(self, residuals, output):
        given, settings = lines(0.05, output=output), Settings(residuals=residuals)
        sizes, coefficients = factors_of(POLES)
        assert sizes == (2, 2, 2)
        best = expand(given, POLES, settings)
        expected = given.weights * (given.values - best.values(given.s, given.powers))
        projection = Projection(given, sizes, settings)
        np.testing.assert_allclose(projection.complex_residuals(np.log(coefficients)), expected, atol=1e-9)

    def test_unknowns(self):
        """Six coefficients, six residues and the ends of each of four pairs."""
        for residuals, ends in (("both", 2), ("lower", 1), ("upper", 1), ("none", 0)):
            assert Projection(lines(), (2, 2, 2), Settings(residuals=residuals)).unknowns == 6 + 4 * (6 + ends)


class TestInformation:
    def test_alike(self):
        rng = np.random.default_rng(3)
        white = rng.normal(size=(4000, 1, 1)) + 1j * rng.normal(size=(4000, 1, 1))
        assert line_correlation(white) == pytest.approx(0, abs=0.03)
        assert line_correlation(white[1:] + white[:-1]) == pytest.approx(0.5, abs=0.03)
        assert line_correlation(white[1:] - white[:-1]) == 0
        assert line_correlation(np.ones((4000, 1, 1), dtype=complex)) == 0.95
        assert line_correlation(np.zeros((5, 1, 1), dtype=complex)) == 0

    def test_criterion_is_schwarzs(self):
        """Of white noise: equations times log of the mean square, plus unknowns times log of all values."""
        given = lines(0.05)
        left = np.array([1.0, -1.0] * 19 + [1.0])[:, None, None] * np.array([[1.0, 2.0], [3.0, 4.0]])
        equations, values = 2 * len(LINES), 2 * len(LINES) * 4
        expected = equations * np.log([1, 4, 9, 16]).sum() + 6 * (2 + 2) * np.log(values)
        assert BicCriterion(given, left).value(left, 6) == pytest.approx(expected, rel=1e-12)
        together = BicCriterion(given, np.ones_like(left))
        fewer = equations * 0.05 / 1.95
        assert line_correlation(np.ones_like(left)) == 0.95
        expected = fewer * np.log([1, 4, 9, 16]).sum() + 6 * 4 * np.log(fewer * 4)
        assert together.value(left, 6) == pytest.approx(expected, rel=1e-12)

    def test_below_the_round_off_nothing_is_gained(self):
        given = lines()
        tiny, tinier = (np.full(given.values.shape, size, dtype=complex) for size in (1e-12, 1e-14))
        judge = BicCriterion(given, tiny)
        assert judge.value(tiny, 4) == judge.value(tinier, 4)

    def test_one_pole_always_stays(self):
        rng = np.random.default_rng(4)
        noise = rng.normal(size=(40, 1, 1)) + 1j * rng.normal(size=(40, 1, 1))
        given = Lines(2j * np.pi * np.linspace(1, 20, 40), noise, np.zeros((1, 1), dtype=int), np.ones((40, 1, 1)))
        kept = significant_poles(given, POLES, np.ones((4, 1), dtype=complex), Settings(residuals="none"))
        assert len(kept) == 1


@pytest.mark.parametrize(("near", "apart"), [(0.0, 1.0), (1.5, 1.0), (3.0, 2.0), (4.0, 2.0), (5.0, 5.0), (99.0, 5.0)])
def test_spacing_of_the_lines_around(near, apart):
    assert line_spacing(np.array([1.0, 2.0, 4.0, 9.0]), near) == apart


def test_spacing_of_few_lines():
    assert line_spacing(np.array([1.0, 4.0]), 2.0) == 3.0
    assert np.isnan(line_spacing(np.array([1.0]), 1.0))


class TestSameAsBefore:
    def order(self, poles, shapes):
        none = np.zeros(len(poles), dtype=bool)
        return Order(
            2, np.asarray(poles), shapes, shapes, np.full(len(poles), -1), none, none, none, np.zeros((1, 1, 1))
        )

    def test_each_criterion_on_its_own(self):
        """Another damping, another frequency, another shape; partners cross over."""
        shapes = np.eye(3, dtype=complex)
        before = self.order([pole(5, 0.02), pole(9, 0.03), pole(14, 0.04)], shapes)
        now = np.array([pole(14.01, 0.0401), pole(5.01, 0.03), pole(9.5, 0.0301)])
        places, (frequency, damping, shape) = _same(now, shapes[[0, 0, 1]], before, Criteria())
        assert places.tolist() == [2, 0, 1]
        assert frequency.tolist() == [True, True, False]
        assert damping.tolist() == [True, False, True]
        assert shape.tolist() == [False, True, True]

    def test_more_poles_than_before(self):
        before = self.order([pole(5, 0.02)], np.ones((1, 1), dtype=complex))
        places, same = _same(
            np.array([pole(9, 0.02), pole(5, 0.02)]), np.ones((2, 1), dtype=complex), before, Criteria()
        )
        assert places.tolist() == [-1, 0]
        assert [flags.tolist() for flags in same] == [[False, True]] * 3


def test_given_poles_that_lie_close_together_stay_apart():
    """With two inputs too every pole keeps a residue of its own in every transfer function: nothing is shared."""
    poles = np.array([pole(10, 0.02), pole(10.05, 0.02)])
    rng = np.random.default_rng(5)
    residues = rng.normal(size=(2, 2, 2)) + 1j * rng.normal(size=(2, 2, 2))
    found = fit_poles(response_of(poles, residues, np.arange(5, 15, 0.1)), poles, Settings(residuals="none"))
    np.testing.assert_allclose(found.residues, residues, rtol=1e-6)
    assert not any("close together" in note for note in found.notes)


class TestChoiceOfTheMethod:
    """Poles drawn by hand, 5 % noise: what each method misses is known, and the choice has to be the other one."""

    def found(self, poles, lines, outputs):
        response = response_of(poles, chain_residues(poles, outputs)[0], lines, noise=0.05)
        return identify_modes(response, Settings())

    @pytest.mark.slow
    def test_a_close_pair_is_taken_from_the_rational_fraction(self):
        poles = [pole(11.0, 0.008), pole(11.165, 0.009), pole(22.0, 0.01)]
        found = self.found(poles, np.arange(2, 30, 0.05), 3)
        np.testing.assert_allclose(found.natural_frequencies, [11.0, 11.165, 22.0], rtol=2e-3)
        assert found.notes[0].startswith("method: rational fraction")

    @pytest.mark.slow
    def test_twelve_light_modes_are_taken_from_lscf(self):
        frequencies = 30 * 4 ** (np.arange(12) / 11)
        poles = [pole(f, 0.007) for f in frequencies]
        found = self.found(poles, np.arange(20, 130, 0.1), 6)
        np.testing.assert_allclose(found.natural_frequencies, frequencies, rtol=4e-3)
        assert found.notes[0].startswith("method: LSCF rather than rational fraction, whose BIC is")
