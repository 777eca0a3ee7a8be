"""Damping measures agree with their definitions, with each other, and in every algebra."""

import math
from fractions import Fraction

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from support.models import sympy_algebra

from torsionnet.base.expression_reading import parse_expression, scalar
from torsionnet.base.expressions import FLOAT, RATIONAL, ExpressionError
from torsionnet.model.damping import MEASURES, DampingError, DampingMeasure, convert_damping

K, F = 1300.0, 12.5
OMEGA = 2 * math.pi * F


@pytest.mark.parametrize(
    ("measure", "eta"),
    [
        ("zeta", 2 * 0.3),
        ("Q", 1 / 0.3),
        ("magnifier", 1 / 0.3),
        ("eta", 0.3),
        ("psi", 0.3 / (2 * math.pi)),
        ("log_decrement", 2 * 0.3 / math.sqrt(4 * math.pi**2 + 0.09)),
        ("c", 0.3 * OMEGA / K),
    ],
)
def test_definitions(measure, eta):
    assert convert_damping(0.3, measure, "eta", stiffness=K, frequency=F) == pytest.approx(eta, rel=1e-14)


def test_all_measures_are_tested_above():
    assert set(MEASURES) == {"zeta", "Q", "magnifier", "eta", "psi", "log_decrement", "c"}
    assert all(measure.symbol and measure.description for measure in MEASURES.values())


def test_psi_is_the_energy_of_a_hysteresis_loop():
    c, phi, steps = 0.7, 0.01, 2000
    speeds = [OMEGA * phi * math.cos(2 * math.pi * i / steps) for i in range(steps)]
    lost = sum(c * speed**2 for speed in speeds) / (steps * F)
    psi = convert_damping(c, "c", "psi", stiffness=K, frequency=F)
    assert lost / (K * phi**2 / 2) == pytest.approx(psi, rel=1e-12)


def test_the_decrement_is_that_of_a_free_oscillator():
    zeta = 0.2
    period = 2 * math.pi / math.sqrt(1 - zeta**2)
    assert convert_damping(zeta, "zeta", "log_decrement") == pytest.approx(zeta * period, rel=1e-14)


def test_zeta_is_that_of_the_oscillator_at_its_resonance():
    inertia = K / OMEGA**2
    c = convert_damping(0.05, "zeta", "c", stiffness=K, frequency=F)
    assert c == pytest.approx(2 * 0.05 * math.sqrt(K * inertia), rel=1e-14)


NAMES = st.sampled_from(sorted(MEASURES))


@given(st.floats(min_value=1e-6, max_value=1.9), NAMES, NAMES, NAMES)
def test_any_way_round_is_the_same(eta, first, second, third):
    def convert(value, measure, to):
        return convert_damping(value, measure, to, stiffness=K, frequency=F)

    there = convert(convert(convert(eta, "eta", first), first, second), second, third)
    assert there == pytest.approx(convert(eta, "eta", third), rel=1e-9)
    assert convert(there, third, "eta") == pytest.approx(eta, rel=1e-9)


@pytest.mark.parametrize(
    ("arguments", "given", "message"),
    [
        ((0.1, "zta", "eta"), {}, r'(?s)did you mean "zeta".*unknown-word'),
        ((0.1, "zeta", "psy"), {}, 'did you mean "psi"'),
        ((0.1, "c", "eta"), {"frequency": 1.0}, "positive stiffness in"),
        ((0.1, "eta", "c"), {"stiffness": 1.0}, "positive frequency in Hz"),
        ((0.1, "c", "eta"), {"stiffness": 0.0, "frequency": 1.0}, "out-of-range"),
        ((0.1, "c", "eta"), {"stiffness": 1.0, "frequency": -1.0}, "out-of-range"),
        ((0.1, "c", "eta"), {"stiffness": 1.0, "frequency": math.inf}, "got inf"),
        ((0.0, "Q", "eta"), {}, "not-finite"),
        ((0.0, "zeta", "Q"), {}, "not-finite"),
        ((1.0, "zeta", "log_decrement"), {}, "needs zeta below 1"),
        ((math.nan, "zeta", "eta"), {}, "finite"),
        ((math.inf, "Q", "eta"), {}, "finite"),
    ],
)
def test_refused(arguments, given, message):
    with pytest.raises(DampingError, match=message) as caught:
        convert_damping(*arguments, **given)
    assert isinstance(caught.value, ValueError)


def test_c_to_c_needs_nothing_else():
    assert convert_damping(3.0, "c", "c") == 3.0


# DampingMeasure


@given(st.floats(min_value=1e-3, max_value=1.5), NAMES)
def test_the_measure_of_a_spring_agrees_with_the_converter(value, measure):
    import sympy

    damping = DampingMeasure(measure, scalar(value), scalar(F))
    expected = convert_damping(value, measure, "c", stiffness=K, frequency=F)
    for algebra, stiffness in ((FLOAT, K), (RATIONAL, Fraction(K))):
        assert float(damping.viscous(stiffness, {}, algebra)) == pytest.approx(expected, rel=1e-12)
    assert float(damping.viscous(sympy.Float(K), {}, sympy_algebra())) == pytest.approx(expected, rel=1e-12)
    assume(measure != "c")
    eta = convert_damping(value, measure, "eta")
    assert float(damping.loss_factor({}, FLOAT)) == pytest.approx(eta, rel=1e-12)


def test_rational_loss_factors_stay_exact():
    assert DampingMeasure("Q", scalar(30)).loss_factor({}, RATIONAL) == Fraction(1, 15) / 2
    assert DampingMeasure("zeta", scalar("3 %")).loss_factor({}, RATIONAL) == Fraction(6, 100)


def test_symbols():
    import sympy

    k, zeta, f = sympy.symbols("k zeta f", positive=True)
    damping = DampingMeasure("zeta", parse_expression("zeta"), parse_expression("2*f_0"))
    assert damping.names == {"zeta", "f_0"}
    c = damping.viscous(k, {"zeta": zeta, "f_0": f}, sympy_algebra())
    assert sympy.simplify(c - zeta * k / (2 * sympy.pi * f)) == 0
    delta = DampingMeasure("log_decrement", parse_expression("d")).loss_factor({"d": zeta}, sympy_algebra())
    assert sympy.simplify(delta - 2 * zeta / sympy.sqrt(4 * sympy.pi**2 + zeta**2)) == 0


def test_c_is_passed_through():
    assert DampingMeasure("c", scalar("4 Nms/rad")).viscous(K, {}, RATIONAL) == 4
    assert DampingMeasure("c", scalar(4)).names == frozenset()


def test_frequency_units():
    at = DampingMeasure("eta", scalar(0.1), scalar("750 cpm"))
    assert at.viscous(K, {}, FLOAT) == pytest.approx(0.1 * K / OMEGA, rel=1e-14)
    with pytest.raises(DampingError, match="wrong-unit"):
        DampingMeasure("eta", scalar(0.1), scalar("78 rad/s"))


def test_measures_without_an_answer():
    with pytest.raises(DampingError, match='did you mean "zeta"'):
        DampingMeasure("Zeta", scalar(1))
    with pytest.raises(DampingError, match=r"(?s)50.*missing-entry"):
        DampingMeasure("eta", scalar(1)).viscous(K, {}, FLOAT)
    with pytest.raises(DampingError, match="missing-entry"):
        DampingMeasure("c", scalar(1)).loss_factor({}, FLOAT)
    with pytest.raises(DampingError, match="out-of-range"):
        DampingMeasure("Q", parse_expression("q")).loss_factor({"q": 0}, FLOAT)
    with pytest.raises(DampingError, match="out-of-range"):
        DampingMeasure("eta", scalar(1), scalar(0)).viscous(K, {}, FLOAT)
    with pytest.raises(ExpressionError, match="no parameter"):
        DampingMeasure("eta", parse_expression("e"), scalar(1)).viscous(K, {}, FLOAT)


def test_zero_is_refused_in_symbols_too():
    with pytest.raises(DampingError, match="is 0"):
        DampingMeasure("Q", scalar(0)).loss_factor({}, sympy_algebra())
    with pytest.raises(DampingError, match="is 0"):
        DampingMeasure("eta", scalar(1), scalar(0)).viscous(K, {}, sympy_algebra())
