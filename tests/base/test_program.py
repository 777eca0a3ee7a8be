"""Recorded calculations: one record of a law, evaluated as numbers, symbols and text, and branches on values."""

from fractions import Fraction

import pytest

import torsionnet as tn
from torsionnet.base.expressions import Name, exact
from torsionnet.base.program import Program, ProgramAlgebra, Record
from torsionnet.io.modelica_parts import WrittenRecord
from torsionnet.linear.assembly.symbolic import SymbolRecord, symbol_of
from torsionnet.model.elements import Values

PRESENT = {"J": 3, "f": 1.5, "zeta": 0.1}
OTHERS = {"J": 0.7, "f": 4, "zeta": 0.25}


class Numbers(ProgramAlgebra):
    """Recorded numbers at other values of the parameters."""

    def leaf(self, payload):
        if isinstance(payload, Fraction):
            return float(payload)
        return float(OTHERS[payload.name] if isinstance(payload, Name) else payload.evaluate({}))


def layer(parameters, algebra=None):
    """Law of the layer of a tuned damper, with pi and a root in it."""
    damper = tn.TunedDamper("e", node="a", ring_inertia="J", natural_frequency="f", damping_ratio="zeta")
    return damper.parts(Values(parameters, algebra) if algebra else Values(parameters))[0]


def recorded(record):
    return layer({name: record.parameter(name, value) for name, value in PRESENT.items()}, record.algebra)


@pytest.mark.parametrize("kind", [Record, SymbolRecord])
@pytest.mark.parametrize("coefficient", ["stiffness", "damping"])
def test_a_recorded_law_holds_for_other_values(kind, coefficient):
    """The element's own law in fractions, at the present values and at others."""
    number = getattr(recorded(kind()), coefficient)
    present, others = (
        getattr(layer({name: exact(value) for name, value in values.items()}), coefficient)
        for values in (PRESENT, OTHERS)
    )
    assert float(number) == pytest.approx(float(present), rel=1e-14)
    assert number.program.values_in(Numbers(), [number])[0] == pytest.approx(float(others), rel=1e-14)


@pytest.mark.parametrize("coefficient", ["stiffness", "damping"])
def test_symbols_and_text_of_a_recorded_law(coefficient):
    symbol = symbol_of(getattr(recorded(SymbolRecord()), coefficient))
    record = WrittenRecord()
    expression = record.expression(getattr(recorded(record), coefficient))
    expected = float(getattr(layer({name: exact(value) for name, value in OTHERS.items()}), coefficient))
    assert float(symbol.subs(OTHERS)) == pytest.approx(expected, rel=1e-14)
    assert float(expression.evaluate({name: exact(value) for name, value in OTHERS.items()})) == pytest.approx(expected)
    assert str(expression).startswith("J*(2*pi*f)**2" if coefficient == "stiffness" else "2*zeta*sqrt(")


def test_a_program_without_values_refuses_branches():
    program = Program()
    x, y = program.leaf("x"), program.leaf("y")
    with pytest.raises(TypeError, match="cannot be recorded"):
        assert x < y
    assert x == program.leaf("x")
    assert x != y


def test_branches_on_values_are_recorded():
    record = Record()
    a, b = record.parameter("a", 0.1), record.parameter("b", 0.2)
    assert 2 * a == b
    assert a != b
    assert b > 0.15
    assert {sign for sign, _, _ in record.decisions} == {"==", "<"}
    assert record.steps[0] == ("leaf", Name("a"))


def test_equal_steps_are_recorded_once():
    record = Record()
    a, b = record.parameter("a", 2), record.parameter("b", 3)
    first, second = (a + b) ** 2 / b, (b + a) * (a + b) / b
    assert first is second
    assert first.value == Fraction(25, 3)


def test_numbers_of_two_records_do_not_mix():
    with pytest.raises(AssertionError, match="two records"):
        Record().parameter("a", 1) + Record().parameter("a", 1)
