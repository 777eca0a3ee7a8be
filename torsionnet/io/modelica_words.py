"""Names, units and expressions as Modelica writes them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from torsionnet.core.damping import DampingMeasure
from torsionnet.core.expressions import Expression
from torsionnet.core.units import DIMENSIONS, Dimension
from torsionnet.io.open_numbers import open_values
from torsionnet.model.elements import Values
from torsionnet.model.elements.element import viscous

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
"""Names that no component gets."""
UNITS = {
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
}
"""Modelica's way of writing units; a torque and a stiffness have one dimension as rad is 1, the stiffness wins."""
LARGEST_INTEGER = 2**31 - 1

_NAME = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*")
_INTEGER = re.compile(r"(?<![\w.])\d+(?![\w.])")


class ModelicaWords:
    """Expressions of a model with its parameters under the names they have in Modelica."""

    def __init__(self, names: Mapping[str, str], values: Mapping[str, Any]) -> None:
        self.names, self.values, self.open = names, Values(values), open_values(values)

    def expression(self, value: Expression) -> str:
        """An expression in SI; equal to the model's for any values of the parameters."""
        text = _NAME.sub(self._name, value.written()[0].replace("**", "^"))
        return _INTEGER.sub(lambda found: f"{found[0]}.0" if int(found[0]) > LARGEST_INTEGER else found[0], text)

    def _name(self, found: re.Match[str]) -> str:
        known = {"pi": "Modelica.Constants.pi", "sqrt": "sqrt"}
        return known.get(found[0]) or self.names[found[0]]

    def damping(self, value: Any, stiffness: Any) -> str:
        """A viscous coefficient; one given by a damping measure as a number."""
        if isinstance(value, DampingMeasure):
            return repr(float(viscous(value, self.values(stiffness), self.values)))
        return "0" if value is None else self.expression(value)


def factor(text: str) -> str:
    """An expression as part of a product.

    >>> factor("a + b"), factor("k_1")
    ('(a + b)', 'k_1')
    """
    return text if re.fullmatch(r"[\w.]+", text) else f"({text})"


def unit_of(dimension: Dimension | None) -> str:
    """Modelica's unit of a dimension; empty where there is none to tell."""
    return next((unit for name, unit in UNITS.items() if dimension == DIMENSIONS[name]), "")


def quoted(text: str) -> str:
    """A description on one line, in quotes."""
    plain = " ".join(text.split()).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{plain}"'


def written_unit(unit: str) -> str:
    """An SI unit as Modelica and FMI write it.

    >>> written_unit("N*m"), written_unit("rad/s^2")
    ('N.m', 'rad/s2')
    """
    return unit.replace("*", ".").replace("^", "")
