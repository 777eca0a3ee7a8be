"""Expressions from files: what is allowed is exact, what is not is refused before anything happens."""

import contextlib
import keyword
import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import campaigns
from support.models import sympy_algebra

from torsionnet.base.errors import TorsionnetError
from torsionnet.base.expression_reading import RESERVED_NAMES, check_name, parse_expression, scalar
from torsionnet.base.expressions import FLOAT, RATIONAL, Compound, Expression, ExpressionError, Name, Number
from torsionnet.base.units import DIMENSIONS, UnitError

VALUES = {"k_1": Fraction(3), "J": Fraction(1, 2), "tau": Fraction(-2), "x": Fraction(9, 4)}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2*k_1", 6),
        ("k_1 + J/2 - 1", Fraction(9, 4)),
        ("k_1/tau**2", Fraction(3, 4)),
        ("k_1/tau^2", Fraction(3, 4)),
        ("-tau**2", -4),
        ("(-tau)**3", 8),
        ("(k_1 - 3)**0", 1),
        ("2**-2", Fraction(1, 4)),
        ("sqrt(x)", Fraction(3, 2)),
        ("x**0.5", Fraction(3, 2)),
        ("x**(3/2)", Fraction(27, 8)),
        ("0.1 + 0.2", Fraction(3, 10)),
        ("1e-3*k_1", Fraction(3, 1000)),
        ("1/3/2", Fraction(1, 6)),
        ("1 - 2 - 3", -4),
        ("1-(2-3)", 2),
        ("8/(4/2)", 4),
        ("--k_1", 3),
        ("+k_1", 3),
    ],
)
def test_rational_evaluation_is_exact(text, value):
    result = parse_expression(text).evaluate(VALUES)
    assert isinstance(result, Fraction)
    assert result == value


def test_pi_and_roots_become_floats_where_they_must():
    assert parse_expression("pi/2").evaluate({}) == math.pi / 2
    assert parse_expression("sqrt(2)").evaluate({}) == math.sqrt(2)
    assert parse_expression("sqrt(x)").evaluate({"x": 2.25}, FLOAT) == 1.5


def test_sympy_through_its_algebra():
    import sympy

    G, d, length = sympy.symbols("G d l")
    stiffness = parse_expression("0.1*G*pi*d**4/(32*l)").evaluate({"G": G, "d": d, "l": length}, sympy_algebra())
    assert sympy.simplify(stiffness - sympy.Rational(1, 320) * G * sympy.pi * d**4 / length) == 0
    assert (
        parse_expression("sqrt(8)*d^1.5").evaluate({"d": d}, sympy_algebra()) == 2 * sympy.sqrt(2) * sympy.sqrt(d) ** 3
    )
    with pytest.raises(ExpressionError, match="division by zero"):
        parse_expression("1/(d - d)").evaluate({"d": d}, sympy_algebra())


def test_arrays_pass_through():
    result = parse_expression("k/(2*J)").evaluate({"k": np.array([2.0, 4.0]), "J": np.array([1.0, 2.0])}, FLOAT)
    assert result.tolist() == [1.0, 1.0]


def test_names():
    assert parse_expression("a*b_2 + sqrt(c)/pi - (-a)**2").names == {"a", "b_2", "c"}
    assert parse_expression("2*pi").names == frozenset()


@pytest.mark.parametrize(
    ("text", "values", "message"),
    [
        ("1/x", {"x": 0}, "incalculable-value"),
        ("1/(x-x)", {"x": 1.5}, "division by zero"),
        ("x**-1", {"x": Fraction(0)}, "division by zero"),
        ("1/0", {}, "division by zero"),
        ("sqrt(x)", {"x": Fraction(-2)}, "incalculable-value"),
        ("x**0.5", {"x": -2.0}, "no square root"),
        ("x**4", {"x": Fraction(10**300)}, "too large"),
        ("x**4", {"x": 1e300}, "too large"),
        ("x*x", {"x": 1e300}, "too large"),
        ("gerbox", {"gearbox": 1}, r'(?s)did you mean "gearbox".*unknown-parameter'),
    ],
)
def test_values_without_an_answer(text, values, message):
    with pytest.raises(ExpressionError, match=message):
        parse_expression(text).evaluate(values)


@pytest.mark.parametrize(
    ("text", "offset", "message"),
    [
        ("__import__('os').system('ls')", 11, "not allowed"),
        ("().__class__", 2, "decimal numbers"),
        ("a.__class__", 0, "a letter comes first"),
        ("__class__", 0, "a letter comes first"),
        ("_a", 0, "a letter comes first"),
        ("9**9**9", 6, "an exponent is"),
        ("(9**4)**4", 0, "power of a power"),
        ("((9**4 + 1)*2)**4", 0, "power of a power"),
        ("sqrt(a**2)**2", 0, "power of a power"),
        ("2**5", 3, "at most 4"),
        ("a**0.25", 3, "whole or half"),
        ("a**b", 3, "an exponent is"),
        ("a^b", 2, "an exponent is"),
        ("a**(b)", 4, "an exponent is"),
        ("(x := 3)", 3, '":" is not allowed'),
        ("lambda: 1", 6, "not allowed"),
        ("lambda x", 0, "unreadable-expression"),
        ("a if b else c", 2, "operator is missing|Python language"),
        ("not a", 0, "Python language"),
        ("a and b", 2, "operator is missing|Python language"),
        ("True", 0, "Python language"),
        ("None", 0, "Python language"),
        ("a < b", 2, "not allowed"),
        ("a == b", 2, "not allowed"),
        ("[1]", 0, "not allowed"),
        ("'a'", 0, "not allowed"),
        ("f'{a}'", 1, "not allowed"),
        ("a, b", 1, "not allowed"),
        ("a % b", 2, "not allowed"),
        ("a // b", 0, "nothing else"),
        ("a\nb", 1, "not allowed"),
        ("größe", 2, "not allowed"),
        ("ａ", 0, "not allowed"),
        ("omega*2", 0, "reserved"),
        ("2*s", 2, "reserved"),
        ("exp(2)", 0, "unreadable-expression"),
        ("a(2)", 0, "unreadable-expression"),
        ("2(a)", 0, "unreadable-expression"),
        ("sqrt", 0, "allowed are"),
        ("sqrt()", 0, "allowed are"),
        ("sqrt(*a)", 5, "allowed are"),
        ("sqrt(**a)", 0, "allowed are"),
        ("2 a", 2, "operator is missing"),
        ("2a", 1, "operator is missing"),
        ("(a) b", 4, "operator is missing"),
        ("0x1f", 1, "operator is missing"),
        ("1j", 1, "operator is missing"),
        ("1_000", 1, "operator is missing"),
        ("017", 0, "octal"),
        ("1e400", 0, "too large"),
        ("2*1e999999999", 2, "too large"),
        ("inf", 0, "no finite number"),
        ("NaN", 0, "no finite number"),
        ("a +", 3, "expression is incomplete here"),
        ("(a", 0, "expression is incomplete here"),
        ("a^^2", 2, "expression is incomplete here"),
        ("...", 0, "decimal numbers"),
        ("1.2.3", 3, "operator is missing"),
        (" a^2 + $", 7, r'"\$" is not allowed'),
        ("a^2*b^2*c .d", 10, "decimal numbers"),
    ],
)
def test_refused_at_its_place(text, offset, message):
    with pytest.raises(ExpressionError, match=message) as caught:
        parse_expression(text)
    assert caught.value.offset == min(offset, len(text) - 1)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "1 to 200 characters"),
        ("  ", "1 to 200 characters"),
        ("a" * 201, r"(?s)200.*201.*unreadable-expression"),
        ("+".join("a" * 40), "more than 60 numbers"),
        ("-" * 199 + "a", "more than 20 levels"),
        ("-" * 30 + "a", "more than 20 levels"),
        ("sqrt(" * 21 + "a" + ")" * 21, "more than 20 levels"),
        ("(" * 100 + ")" * 100, "allowed are numbers"),
        ("(" * 199 + "a", "expression is incomplete here"),
        ("1e300/1e-300", "too large"),
    ],
)
def test_bounds(text, message):
    with pytest.raises(ExpressionError, match=message):
        parse_expression(text)


def test_long_sums_are_not_deep():
    assert parse_expression("+".join("a" * 30)).evaluate({"a": Fraction(1)}) == 30
    assert parse_expression("(" * 90 + "a" + ")" * 90) == Name("a")


def test_nothing_is_evaluated(monkeypatch):
    def trap(*_):
        pytest.fail("Python evaluated a text")

    monkeypatch.setattr("builtins.eval", trap)
    parse_expression.cache_clear()
    assert parse_expression("2*abs_").evaluate({"abs_": 1}) == 2
    with pytest.raises(ExpressionError):
        parse_expression("print(1)")


def test_check_name():
    for good in ("k_1", "J", "tau", "kNm", "no", "e", "left.k_1", "engine.cyl3.J"):
        assert check_name(good) is None
    for bad in (
        *RESERVED_NAMES,
        *keyword.kwlist,
        "",
        "1a",
        "_a",
        "a b",
        "a-b",
        "é",
        "nan",
        "a\n",
        "a.",
        ".a",
        "a..b",
        "a.1",
        "a._b",
        "a.s",
    ):
        assert check_name(bad)


# Round trips


def fractions():
    return st.fractions(min_value=-1000, max_value=1000, max_denominator=1000)


LEAVES = st.one_of(
    st.builds(Number, fractions()),
    st.builds(Number, st.integers(-99, 99)),
    st.builds(Number, st.floats(min_value=-1e20, max_value=1e20)),
    st.builds(Name, st.sampled_from(["k_1", "J", "tau", "x"])),
    st.just(Compound("pi")),
)
FLAT = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.builds(Compound, st.sampled_from(["negative", "sqrt"]), st.tuples(inner)),
        st.builds(Compound, st.sampled_from("+-*/"), st.tuples(inner, inner)),
    ),
    max_leaves=3,
)
EXPONENTS = st.sampled_from([Number(Fraction(n, 2)) for n in range(-8, 9)])
TREES = st.recursive(
    st.one_of(LEAVES, st.builds(Compound, st.just("**"), st.tuples(FLAT, EXPONENTS))),
    lambda inner: st.one_of(
        st.builds(Compound, st.sampled_from(["negative", "sqrt"]), st.tuples(inner)),
        st.builds(Compound, st.sampled_from("+-*/"), st.tuples(inner, inner)),
    ),
    max_leaves=6,
)


@pytest.mark.slow
@settings(max_examples=campaigns.examples(150, 400))
@given(TREES)
def test_the_text_of_any_tree_parses_back(tree):
    if len(str(tree)) > 200:
        return
    try:
        parsed = parse_expression(str(tree))
    except ExpressionError as error:
        raise AssertionError(str(tree)) from error
    assert parsed == tree
    assert hash(parsed) == hash(tree)
    assert parsed.names == tree.names


@settings(max_examples=campaigns.examples(150, 400))
@given(st.text(alphabet="ab2.5+-*/^() e", max_size=30))
def test_what_is_read_means_the_same_as_in_python(text):
    with contextlib.suppress(ExpressionError):
        tree = parse_expression(text)
        values = {"a": Fraction(3, 7), "b": Fraction(-5, 3), "e": Fraction(2), "ab": 1, "ba": 1}
        if tree.names <= values.keys():
            ours = tree.evaluate(values)
            python = eval(text.strip().replace("^", "**"), {"__builtins__": {}}, values)
            assert float(ours) == pytest.approx(float(python), rel=1e-9, abs=1e-12)
        assert parse_expression(str(tree)) == tree


@given(st.text(max_size=220))
def test_any_text_is_read_or_refused(text):
    for read in (parse_expression, scalar):
        with contextlib.suppress(ExpressionError):
            assert isinstance(read(text), Expression)


@pytest.mark.slow
@given(st.text(max_size=210).filter(str.strip))
def test_refusals_point_into_the_text(text):
    try:
        parse_expression(text)
    except ExpressionError as error:
        offset = error.offset
    else:
        offset = None
    assert offset is None or 0 <= offset < len(text)


# Dimensions

UNITS = {"k": DIMENSIONS["stiffness"], "J": DIMENSIONS["inertia"], "f": DIMENSIONS["frequency"], "u": None,
         "tau": DIMENSIONS["1"]}  # fmt: skip


@pytest.mark.parametrize(
    ("text", "dimension"),
    [
        ("2*k", "stiffness"),
        ("k + k/2", "stiffness"),
        ("k*tau**2", "stiffness"),
        ("k + 2", "stiffness"),
        ("2 - k", "stiffness"),
        ("k + u", "stiffness"),
        ("u + k", "stiffness"),
        ("-k", "stiffness"),
        ("sqrt(k/J)", "speed"),
        ("(k/J)^0.5", "speed"),
        ("k/k", "1"),
        ("1/k", "compliance"),
        ("1 + tau", "1"),
        ("2*pi", None),
        ("2", None),
        ("u", None),
        ("u*k", None),
        ("2*u*k", None),
        ("k/u", None),
        ("sqrt(u)*k", None),
        ("(u + 2)*k", None),
        ("(2 + u)*k", None),
    ],
)
def test_dimension(text, dimension):
    expected = None if dimension is None else DIMENSIONS[dimension]
    assert parse_expression(text).dimension(UNITS) == expected


@pytest.mark.parametrize("text", ["k + J", "k - J", "2*(u + k + J)", "sqrt(k*k + J)"])
def test_different_dimensions_do_not_add(text):
    with pytest.raises(ExpressionError, match=r"kg\*m\^2"):
        parse_expression(text).dimension(UNITS)


def test_both_dimensions_are_named():
    with pytest.raises(ExpressionError, match="wrong-unit"):
        parse_expression("k - J").dimension(UNITS)
    with pytest.raises(ExpressionError, match="no parameter"):
        parse_expression("z").dimension(UNITS)


# Scalars


@pytest.mark.parametrize(
    ("given", "value"),
    [
        (3, 3),
        (0.1, Fraction(1, 10)),
        (1e22, 10**22),
        (Fraction(1, 3), Fraction(1, 3)),
        (np.float64(0.1), Fraction(1, 10)),
        (np.int64(2**60 + 1), 2**60 + 1),
        ("0.1", Fraction(1, 10)),
        (" 1e3 ", 1000),
        ("-2", -2),
    ],
)
def test_numbers(given, value):
    assert scalar(given) == Number(value)
    assert scalar(str(scalar(given))) == Number(value)


@pytest.mark.parametrize("text", ["0.46 kN*m/rad", "13.3kNm/rad", "0.5 kg*m^2 GD2", "3 %", "90°", "5 µm", "1 deg/Nm"])
def test_quantities_keep_their_text(text):
    quantity = scalar(text)
    assert isinstance(quantity, Number)
    assert str(quantity) == text
    assert scalar(str(quantity)) == quantity


def test_a_quantity_without_text_writes_its_unit():
    made = Number(Fraction(460), DIMENSIONS["stiffness"])
    assert str(made) == "460 N*m"
    assert scalar(str(made)) == made == scalar("0.46 kN*m/rad")
    assert made != Number(Fraction(460))


@pytest.mark.parametrize("text", ["2*k_1", "2 * k_1", "k_1", "1/(2*k)", "3 - k", "2e3*k", "-k", "2^2", "(1)", "5 / k"])
def test_expressions(text):
    assert scalar(text) == parse_expression(text)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (True, "not-a-number"),
        (np.True_, "expected a number"),
        (None, "expected a number"),
        (1j, "expected a number"),
        ([1], "expected a number"),
        (math.nan, "finite"),
        (math.inf, "finite"),
        (-math.inf, "finite"),
        (10**400, "too large"),
        ("2 k_1", "unknown-unit"),
        ("2k_1", r"write 2\*k_1"),
        ("13,3 kNm/rad", r"decimal comma; write 13\.3"),
        ("3:1", r"(?s)3\.0.*not-a-number"),
        ("1e400", "too large"),
        ("017", "octal"),
        ("nan", "no finite number"),
        ("-.inf", "decimal numbers"),
        ("460 kNn/rad", 'did you mean "kN"'),
        ("2*k_1 N*m/rad", "operator is missing"),
        ("", "1 to 200 characters"),
    ],
)
def test_refused_scalars(given, message):
    with pytest.raises(ExpressionError, match=message) as caught:
        scalar(given)
    assert isinstance(caught.value, TorsionnetError)
    assert isinstance(caught.value, ValueError)


def test_an_expression_passes():
    tree = parse_expression("2*k")
    assert scalar(tree) is tree


def test_a_number_made_by_hand_is_finite():
    with pytest.raises(UnitError):
        Number(math.nan)


@pytest.mark.parametrize(
    ("magnitude", "unit", "value", "dimension"),
    [
        (460, "N*m/rad", 460, "stiffness"),
        (0.46, "kN*m/rad", 460, "stiffness"),
        (0.078, "kg*m**2", Fraction(78, 1000), "inertia"),
        (4.0, "N*m*s/rad", 4, "damping"),
        (60, "rpm", 2 * math.pi, "speed"),
        (180, "degree", math.pi, "angle"),
        (1, "turn", 2 * math.pi, "angle"),
        (2, "lbf*inch", 2 * Fraction("4.4482216152605") * Fraction("0.0254"), "torque"),
        (3, "dyne*cm", Fraction(3, 10**7), "torque"),
        (50, "Hz", 50, "frequency"),
        (2, "kHz", 2000, "frequency"),
        (20, "%", Fraction(1, 5), "1"),
        (np.float64(80), "GPa", 80 * 10**9, "shear modulus"),
    ],
)
def test_pint_quantities(magnitude, unit, value, dimension):
    import pint

    quantity = scalar(magnitude * pint.get_application_registry().Unit(unit))
    assert float(quantity.value) == pytest.approx(float(value), rel=1e-14)
    assert quantity.unit_dimension == DIMENSIONS[dimension]


def test_pint_quantities_that_do_not_fit():
    import pint

    registry = pint.get_application_registry()
    assert scalar(registry.Quantity(2.0, "")) == Number(2)
    for wrong in (registry.Quantity([1.0, 2.0], "m"), registry.Quantity(1.0, "ampere"), registry.Quantity(1.0, "1/s")):
        with pytest.raises(ExpressionError):
            scalar(wrong)


def test_rational_is_the_default():
    assert parse_expression("1/3").evaluate({}) == parse_expression("1/3").evaluate({}, RATIONAL) == Fraction(1, 3)
    assert isinstance(parse_expression("1/3").evaluate({}, FLOAT), float)


def test_names_with_dots_are_read_and_written_equally():
    tree = parse_expression("2*left.k - sqrt(engine.cyl3.k_1)/4")
    assert tree.names == {"left.k", "engine.cyl3.k_1"}
    assert parse_expression(str(tree)) == tree
    assert tree.evaluate({"left.k": Fraction(3), "engine.cyl3.k_1": Fraction(16)}) == 5
