"""Names, units and expressions of a model as Modelica writes them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

from torsionnet.base.expressions import Expression, Name, Number
from torsionnet.base.units import DIMENSIONS, Dimension
from torsionnet.io.expression_numbers import expression_values
from torsionnet.model.damping import DampingMeasure
from torsionnet.model.element_base.element import viscous
from torsionnet.model.elements import Element, Values

ROTATIONAL = "Modelica.Mechanics.Rotational"
_RESERVED = """
algorithm and annotation block break class connect connector constant constrainedby der discrete each else elseif
elsewhen encapsulated end enumeration equation expandable extends external false final flow for function if import
impure in initial inner input loop model not operator or outer output package parameter partial protected public pure
record redeclare replaceable return stream then true type when while within time Real Integer Boolean String Modelica
abs sign sqrt sin cos exp log pre edge change sample reinit terminal noEvent smooth delay assert mod rem div ceil floor
integer min max sum product fill zeros ones ndims size vector matrix transpose cross skew
"""
KEYWORDS = frozenset(_RESERVED.split())
"""Words of the Modelica language that no component may have as its name."""
MODELICA_UNITS = {
    "inertia": "kg.m2",
    "stiffness": "N.m/rad",
    "torque": "N.m",
    "damping": "N.m.s/rad",
    "angle": "rad",
    "speed": "rad/s",
    "length": "m",
    "mass": "kg",
    "density": "kg/m3",
    "shear modulus": "Pa",
    "frequency": "Hz",
    "acceleration": "rad/s2",
    "pressure": "Pa",
    "time": "s",
    "power": "W",
    "area": "m2",
    "temperature": "K",
    "force": "N",
    "linear stiffness": "N/m",
    "velocity": "m/s",
    "1": "1",
}
"""Units as Modelica writes them, by kind of quantity, as torque and stiffness share a dimension (rad is 1)."""
_ALIKE = {DIMENSIONS["stiffness"]: ("stiffness", "torque"), DIMENSIONS["angle"]: ("angle", "1")}
"""Kinds of quantity that share a dimension, first the one with an angle in its unit, then the one without."""
LARGEST_INTEGER = 2**31 - 1
"""Largest value of Modelica's Integer, above which whole numbers are written as Real."""

_NAME = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*")
_INTEGER = re.compile(r"(?<![\w.])\d+(?![\w.])")


class ModelicaExpressions:
    """Converter of a model's expressions to Modelica, with its parameters under the names they have there."""

    def __init__(self, names: Mapping[str, str], values: Mapping[str, Any]) -> None:
        self.names: Mapping[str, str] = names
        self.values: Values = Values(values)
        self.symbolic: Values = expression_values(values)

    def expression(self, value: Expression) -> str:
        """Modelica text of an expression in SI units; equal to the model's for any values of the parameters."""
        text = _NAME.sub(self._name, value.written()[0].replace("**", "^"))
        return _INTEGER.sub(lambda found: f"{found[0]}.0" if int(found[0]) > LARGEST_INTEGER else found[0], text)

    def _name(self, found: re.Match[str]) -> str:
        known = {"pi": "Modelica.Constants.pi", "sqrt": "sqrt"}
        return known.get(found[0]) or self.names[found[0]]

    def damping(self, value: Any, stiffness: Any) -> str:
        """Modelica text of a viscous damping coefficient in N m s/rad.

        One given by a damping measure becomes a number.
        """
        if isinstance(value, DampingMeasure):
            return repr(float(viscous(value, self.values(stiffness), self.values)))
        return "0" if value is None else self.expression(value)


def factor(text: str) -> str:
    """Modelica text of an expression as part of a product, in brackets where needed.

    >>> factor("a + b"), factor("k_1")
    ('(a + b)', 'k_1')
    """
    return text if re.fullmatch(r"[\w.]+", text) else f"({text})"


def parameter_kinds(elements: Iterable[Element], known: Mapping[str, Dimension | None]) -> dict[str, str]:
    """Kind of quantity (inertia, stiffness, ...) of each parameter, from the entries of elements that use it."""
    found: dict[str, str] = {}
    for element in elements:
        for _, _, expression, kind in element.expressions():
            for name in expression.names:
                alone = isinstance(expression, Name) and known.get(name) is None
                if alone or (kind in MODELICA_UNITS and known.get(name) == DIMENSIONS[kind]):
                    found.setdefault(name, kind)
    return found


def unit_of(dimension: Dimension | None, kind: str | None, value: Expression) -> str:
    """Unit of a parameter as Modelica writes it, empty where none is known.

    ``kind`` is what it is used as, if anything; the unit of ``value`` tells a stiffness from a torque.

    >>> [unit_of(DIMENSIONS["torque"], None, Number(12, text=text)) for text in ("12 N*m", "12 N*m/rad")]
    ['N.m', 'N.m/rad']
    """
    if kind is not None:
        return MODELICA_UNITS.get(kind, "")
    if dimension in _ALIKE:
        kind = _ALIKE[dimension][not (isinstance(value, Number) and value.has_angle)]
        return MODELICA_UNITS[kind]
    return next((unit for name, unit in MODELICA_UNITS.items() if dimension == DIMENSIONS[name]), "")


def quoted(text: str) -> str:
    """Description of a component on one line, in Modelica's quotes."""
    plain = " ".join(text.split()).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{plain}"'


def export_unit(unit: str) -> str:
    """Text of an SI unit as Modelica and FMI write it.

    >>> export_unit("N*m"), export_unit("rad/s^2")
    ('N.m', 'rad/s2')
    """
    return unit.replace("*", ".").replace("^", "")
