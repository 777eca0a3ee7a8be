"""Units are read exactly, refused clearly, and never guessed."""

import ast
import contextlib
import math
import re
import time
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from torsionnet.base.entries.scalars import read_scalar
from torsionnet.base.entries.spec import EntryError
from torsionnet.base.units import (
    ANGLES,
    DIMENSIONS,
    Dimension,
    UnitError,
    convert,
    exact,
    expected_unit,
    numeral_of,
    parse_number,
    parse_quantity,
    parse_unit,
)
from torsionnet.signals.records.channel_choice import quantity_of

LBF = Fraction("4.4482216152605")
INCH = Fraction("0.0254")
LB = Fraction("0.45359237")

EXACT = [
    ("13.3 kNm/rad", 13300, "stiffness"),
    ("13.3kNm/rad", 13300, "stiffness"),
    ("13.3 kN*m/rad", 13300, "stiffness"),
    ("460 N·m/rad", 460, "stiffness"),
    ("460 N⋅m·rad⁻¹", 460, "stiffness"),
    ("460 N m / rad", 460, "stiffness"),
    ("460 Nmm/rad", Fraction(46, 100), "stiffness"),
    ("2 MN*m/rad", 2_000_000, "stiffness"),
    ("2 MNm/rad", 2_000_000, "stiffness"),
    ("1 lbf*in/rad", LBF * INCH, "stiffness"),
    ("0.078 kg*m^2", Fraction(78, 1000), "inertia"),
    ("0.078 kg*m**2", Fraction(78, 1000), "inertia"),
    ("0.078 kgm²", Fraction(78, 1000), "inertia"),
    ("0.078 kg·m²", Fraction(78, 1000), "inertia"),
    ("5 gcm²", Fraction(5, 10**7), "inertia"),
    ("1 lbf·in·s²", LBF * INCH, "inertia"),
    ("1 lb*ft^2", LB * (12 * INCH) ** 2, "inertia"),
    ("1 lb·ft² WR2", LB * (12 * INCH) ** 2, "inertia"),
    ("1 lbf·ft² WR²", LB * (12 * INCH) ** 2, "inertia"),
    ("0.5 kg*m^2 GD2", Fraction(1, 8), "inertia"),
    ("0.5 kg·m² GD²", Fraction(1, 8), "inertia"),
    ("0.5 kgf*m^2 GD2", Fraction(1, 8), "inertia"),
    ("4 Nms/rad", 4, "damping"),
    ("12.5 ns", Fraction(125, 10**10), "time"),
    ("80 MHz", 80 * 10**6, "frequency"),
    ("4 N*m*s/rad", 4, "damping"),
    ("1 rad/Nm", 1, "compliance"),
    ("1 rad/(N*m)", 1, "compliance"),
    ("1 1/(N*m)", 1, "compliance"),
    ("1 lbf*ft", LBF * 12 * INCH, "torque"),
    ("1 kgf*m", Fraction("9.80665"), "torque"),
    ("60 cpm", 1, "frequency"),
    ("50 Hz", 50, "frequency"),
    ("3 rad/s", 3, "speed"),
    ("3 rad/s^2", 3, "acceleration"),
    ("1 mm", Fraction(1, 1000), "length"),
    ("1 µm", Fraction(1, 10**6), "length"),
    ("1 in", INCH, "length"),
    ("1 ft", 12 * INCH, "length"),
    ("80 GPa", 80 * 10**9, "shear modulus"),
    ("1 N/mm^2", 10**6, "shear modulus"),
    ("1 psi", LBF / INCH**2, "shear modulus"),
    ("7850 kg/m^3", 7850, "density"),
    ("7.85 g/cm^3", 7850, "density"),
    ("3 %", Fraction(3, 100), "1"),
    ("1 ms", Fraction(1, 1000), "time"),
    ("2 min", 120, "time"),
    ("300 K", 300, "temperature"),
    ("20 degC", Fraction("293.15"), "temperature"),
    ("20.5 °C", Fraction("293.65"), "temperature"),
    ("-40degC", Fraction("233.15"), "temperature"),
]

WITH_PI = [
    ("60 rpm", 2 * math.pi, "speed"),
    ("1 rev/s", 2 * math.pi, "speed"),
    ("180 deg", math.pi, "angle"),
    ("180°", math.pi, "angle"),
    ("1 rev", 2 * math.pi, "angle"),
    ("1 Nm/deg", 180 / math.pi, "stiffness"),
    ("1 Nm/arcmin", 10800 / math.pi, "stiffness"),
    ("1 deg/Nm", math.pi / 180, "compliance"),
]


@pytest.mark.parametrize(("text", "value", "name"), EXACT)
def test_rational_units_are_exact(text, value, name):
    quantity = parse_quantity(text)
    assert isinstance(quantity.value, Fraction)
    assert quantity.value == value
    assert quantity.dimension == DIMENSIONS[name]
    assert quantity.text == text


@pytest.mark.parametrize(("text", "value", "name"), WITH_PI)
def test_units_with_pi(text, value, name):
    quantity = parse_quantity(text)
    assert quantity.value == pytest.approx(value, rel=1e-15)
    assert quantity.dimension == DIMENSIONS[name]


@pytest.mark.parametrize(
    ("text", "value"), [("1e3", 1000), ("-2.5E-1", Fraction(-1, 4)), (".5", Fraction(1, 2)), ("0", 0)]
)
def test_a_bare_number_has_no_dimension(text, value):
    assert (parse_quantity(text).value, parse_quantity(text).dimension) == (value, None)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("13,3 kN*m/rad", r"decimal comma; write 13\.3"),
        ("1,300.5 Nm", r"(?m)thousands separators; write 1300\.5$"),
        ("1.300,5 Nm", r"(?m)thousands separators; write 1300\.5$"),
        ("13 300 Nm", "thousands separators; write 13300"),
        ("1'000 Nm", "thousands separators; write 1000"),
        ("1_000 Nm", "thousands separators; write 1000"),
        ("1_0 Nm", "digits stand together"),
        ("1.2.3 Nm", "digits stand together"),
        ("017", "octal"),
        ("00.5 Nm", "octal"),
        ("3:1", r"(?s)3\.0.*not-a-number"),
        ("nan", "finite"),
        ("-.inf", "finite"),
        ("Infinity Nm", "expected a number"),
        ("", "expected a number"),
        ("Nm", "expected a number"),
        ("١ Nm", "expected a number"),
        ("1e999999", "not-finite"),
        ("1e-999999999999999999", "not-finite"),
        ("1e400 Nm", "not-finite"),
        ("1e300 GPa", "not-finite"),
        ("1e-300 um^6", "not-finite"),
        ("9" * 101, "at most 100 characters"),
        ("1 kNn/rad", 'did you mean "kN"'),
        ("1 knm", "unknown-unit"),
        ("1 lbin", r'did you mean "lbf\*in"'),
        ("1 kg*m2", r'did you mean "m\^2"'),
        ("1 N-m", r'(?m)write "\*" between units, as in N\*m$'),
        ("1 lb-in-s^2", r'(?m)write "\*" between units, as in lbf\*in\*s\^2$'),
        ("1 oz-in-s2", r'(?m)write "\*" between units, as in ozf\*in\*s\^2$'),
        ("1 lb-ft²", r"(?m)as in lb\*ft²$"),
        ("1 U/min", r'(?s)did you mean "rpm".*unknown-unit'),
        ("1 V/rad", '(?m)"V" is not a known unit$'),
        ("1 Gx", '(?m)"Gx" is not a known unit$'),
        ("1 kHz/krad", "unknown-unit"),
        ("1 N*", "empty part"),
        ("1 N//m", "empty part"),
        ("1 /s", "empty part"),
        ("1 ()", "empty part"),
        ("1 (N*m", r'lacks a "\)"'),
        ("1 N)m", r'"\)" too many'),
        ("1 " + "(" * 11 + "N" + ")" * 11, "nested parentheses"),
        ("1 m^7", "exponent 7"),
        ("1 m^-7", "exponent -7"),
        ("1 m^999999999", "exponent 999999999"),
        ("1 m^(1/0)", "exponent 1/0"),
        ("1 ((((mm^6)^6)^6)^6)^6", "one power per unit"),
        ("1 Nm^2", "one power per unit"),
        ("1 1/s", "unknown-unit"),
        ("1500 1/min", "unknown-unit"),
        ("1 min⁻¹", "unknown-unit"),
        ("1 GD2", "unknown-unit"),
        ("1 N GD2", "unknown-unit"),
        ("1 kg*m^2/GD2", "at the end"),
        ("1 Ω", "cannot be read"),
        ("-274 degC", "below absolute zero"),
        ("1e309 degC", "too large"),
        ("2 W/degC", r"(?s)60.*unknown-unit"),
        ("1 __import__('os')", "cannot be read|not a known unit"),
    ],
)
def test_refused_with_a_message(text, message):
    with pytest.raises(UnitError, match=message):
        parse_quantity(text)


@pytest.mark.parametrize(
    ("text", "value", "dimension"),
    [
        # Definitions in NIST SP 811, appendix B: the pound of 0.45359237 kg, 9.80665 m/s^2, 16 ounces, a kip of 1000 lbf.
        ("16 oz", "0.45359237", "mass"), ("16 ozf", "4.4482216152605", "force"), ("1 kip", "4448.2216152605", "force"),
        ("1 kp*m", "9.80665", "torque"), ("3 daNm", "30", "torque"), ("3 daN*m", "30", "torque"), ("2 kJ", "2000", "torque"),
    ],
)  # fmt: skip
def test_other_units_of_mass_force_and_energy(text, value, dimension):
    read = parse_quantity(text)
    assert (read.value, read.dimension) == (Fraction(value), DIMENSIONS[dimension])


def test_other_units_of_angle_and_speed():
    assert parse_quantity("100 gon").value == pytest.approx(math.pi / 2, rel=1e-15)
    assert parse_quantity("5 kp*m/gon").value == pytest.approx(5 * 9.80665 * 200 / math.pi, rel=1e-15)
    assert parse_quantity("300 r/min").value == parse_quantity("5 rps").value == pytest.approx(10 * math.pi, rel=1e-15)
    assert {parse_unit(text).dimension for text in ("r/min", "rps", "rpm")} == {DIMENSIONS["speed"]}


@pytest.mark.parametrize(
    ("dimension", "text", "hint"),
    [
        ("stiffness", "3 lb*in/rad", "write 3 lbf*in/rad"), ("inertia", "2 lb*in*s^2", "write 2 lbf*in*s^2"),
        ("torque", "16 oz*in", "write 16 ozf*in"), ("inertia", "2 kg*cm*s^2", "write 2 kgf*cm*s^2"),
        ("stiffness", "3 lb*in", "write 3 lbf*in"),
    ],
)  # fmt: skip
def test_a_mass_where_a_force_is_meant_is_told_the_force(dimension, text, hint):
    with pytest.raises(EntryError, match=re.escape(hint)):
        read_scalar(text, dimension)
    with pytest.raises(EntryError) as caught:
        read_scalar("2 lb", dimension)
    assert "lbf" not in str(caught.value)


@pytest.mark.parametrize("text", ["", "   "])
def test_an_empty_unit_is_refused(text):
    with pytest.raises(UnitError, match="empty"):
        parse_unit(text)


def test_a_slash_binds_left_to_right():
    assert parse_unit("N*m/rad/s").dimension == DIMENSIONS["torque"] / DIMENSIONS["time"]
    assert parse_unit("rad/N*m").dimension != DIMENSIONS["compliance"]


def test_a_cycle_is_not_an_angle():
    assert parse_unit("Hz").dimension != parse_unit("rad/s").dimension
    with pytest.raises(UnitError, match="wrong-unit"):
        convert(50, "Hz", "rad/s")


def test_convert():
    assert convert(1500, "rpm", "rad/s") == pytest.approx(50 * math.pi, rel=1e-15)
    assert convert(1, "kNm/rad", "Nm/deg") == pytest.approx(1000 * math.pi / 180, rel=1e-15)
    with pytest.raises(UnitError, match=r"(?m)\(m\) .*\(kg\)$"):
        convert(1, "mm", "kg")


def test_expected_units_have_their_dimension():
    for name, dimension in DIMENSIONS.items():
        unit = parse_unit(expected_unit(name))
        assert (unit.factor, unit.dimension) == (1, dimension)
    with pytest.raises(UnitError, match='did you mean "inertia"'):
        expected_unit("inertai")


def test_units_of_physics_agree():
    assert DIMENSIONS["stiffness"] == DIMENSIONS["torque"]
    assert DIMENSIONS["stiffness"] == DIMENSIONS["inertia"] * DIMENSIONS["speed"] ** 2
    assert DIMENSIONS["damping"] / DIMENSIONS["inertia"] == DIMENSIONS["speed"]
    assert DIMENSIONS["compliance"] * DIMENSIONS["stiffness"] == DIMENSIONS["1"]
    assert DIMENSIONS["shear modulus"] * DIMENSIONS["length"] ** 3 == DIMENSIONS["torque"]


EXPONENTS = st.fractions(min_value=-6, max_value=6, max_denominator=4)
SMALL = EXPONENTS.filter(lambda e: len(str(abs(e))) <= 3)


@pytest.mark.slow
@given(st.builds(Dimension, SMALL, SMALL, SMALL, SMALL, SMALL))
def test_the_text_of_a_dimension_is_a_unit_of_it(dimension):
    if dimension == DIMENSIONS["speed"]:
        assert str(dimension) == "rad/s"
    unit = parse_unit(str(dimension))
    assert (unit.factor, unit.dimension) == (1, dimension)


@pytest.mark.slow
@given(st.builds(Dimension, EXPONENTS, EXPONENTS), st.builds(Dimension, EXPONENTS, EXPONENTS))
def test_dimensions_form_a_group(a, b):
    assert a * b / b == a
    assert (a * b) ** Fraction(1, 2) == a ** Fraction(1, 2) * b ** Fraction(1, 2)
    assert a / a == DIMENSIONS["1"]


@given(
    st.floats(min_value=1e-200, max_value=1e200),
    st.sampled_from([text.split(maxsplit=1)[-1] for text, *_ in EXACT[:1]]),
)
def test_a_float_keeps_its_value(value, unit):
    assert float(parse_quantity(f"{value!r} {unit}").value / 1000) == value


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_exact_is_the_shortest_decimal(value):
    assert float(exact(value)) == value
    assert exact(value) == Fraction(repr(value))


@given(st.fractions(max_denominator=10**6))
def test_numerals_are_exact(value):
    text = numeral_of(value)
    read = Fraction(text) if "/" in text else parse_number(text.lstrip("-")) * (-1 if text[0] == "-" else 1)
    assert read == value


@pytest.mark.parametrize("value", [math.nan, math.inf, 10**400, Fraction(1, 10**400)])
def test_exact_refuses_what_no_float_holds(value):
    with pytest.raises(UnitError):
        exact(value)


@given(st.text(max_size=120))
def test_any_text_is_read_or_refused(text):
    for read in (parse_quantity, parse_unit):
        with contextlib.suppress(UnitError):
            assert read(text).dimension is None or str(read(text).dimension)


@given(st.text(alphabet="0123456789.e+-*/^() Nmkgradslb%²", max_size=100))
def test_any_near_unit_is_read_or_refused(text):
    try:
        quantity = parse_quantity(text)
    except UnitError:
        return
    assert math.isfinite(float(quantity.value))


def test_reading_is_fast():
    """Compared with Python's own parser, which takes as much longer on a slow or busy machine."""
    texts = [f"{i}.{i % 9} kNm/rad" for i in range(1, 1001)]
    best = {}
    for read in [parse_quantity.__wrapped__, lambda text: ast.parse(text.replace(" ", "*"))] * 5:
        start = time.process_time()
        for text in texts:
            read(text)
        best.setdefault(read, []).append(time.process_time() - start)
    ours, python = (min(times) for times in best.values())
    assert ours < 4 * python  # 0.7 of it


def test_every_unit_of_angle_is_one_everywhere():
    """Also in the headings of records, and over a time."""
    assert ANGLES == {"rad", "mrad", "urad", "deg", "rev", "arcmin", "gon"}
    for name in ANGLES:
        assert quantity_of(name) == "angle", name
        assert parse_quantity(f"2 {name}/s").dimension == DIMENSIONS["speed"], name
