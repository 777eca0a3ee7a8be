"""Modelica components of any element, made from its laws and constraints."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from typing import Any, TypeAlias

from torsionnet.base.expressions import Compound, Expression, Name, Number
from torsionnet.base.plain_names import Names
from torsionnet.base.program import ProgramNode, Record
from torsionnet.base.registers import Groups
from torsionnet.base.units import DIMENSIONS, Dimension
from torsionnet.model.damping import DampingMeasure
from torsionnet.model.element_base.element import viscous
from torsionnet.model.elements import GROUND, Action, Constraint, Element, Law, Part, Row, Values

# Declarations and connection sets of a Modelica model while its text is put together.


class Net:
    """Declarations of a Modelica model, and the points that are connected (nodes, ports of elements, flanges)."""

    def __init__(self, names: Names) -> None:
        self.names = names
        self.declarations: list[str] = []
        self.equations: list[str] = []
        self.points: Groups[str] = Groups[str]()

    def declare(self, kind: str, wish: str, values: str = "", comment: str = "") -> str:
        """Declare a Modelica component of a type and return its name."""
        name = self.names.new(wish)
        modifiers = f"({values})" if values else ""
        self.declarations.append(f"{kind} {name}{modifiers}{f' {comment}' if comment else ''};")
        return name

    def connections(self) -> list[str]:
        """Lines of ``connect`` equations from the first flange of every set to all others, with the set's nodes."""
        lines: list[str] = []
        for name, points in self.points.home.items():
            if points[0] != name:
                continue
            flanges = [point for point in points if ":" not in point]
            nodes = [point.removeprefix("node:") for point in points if point.startswith("node:")]
            if len(flanges) > 1:
                lines.append(f"// {', '.join(nodes) or 'inside an element'}")
                lines += [f"connect({flanges[0]}, {other});" for other in flanges[1:]]
        return lines


@dataclass(eq=False)
class WrittenRecord(Record):
    """Record with differences, powers and the order of operands as they are written, so that an export can write them.

    Examples
    --------
    >>> import torsionnet as tn
    >>> record = WrittenRecord()
    >>> values = Values({"k": record.parameter("k", 5)}, record.algebra)
    >>> (law,) = tn.Spring("s", nodes=("a", "b"), stiffness="2*k").parts(values)
    >>> float(law.stiffness), str(record.expression(law.stiffness))
    (10.0, '2*k')
    """

    def _pair(self, left: ProgramNode, right: ProgramNode) -> tuple[int, int]:
        return left.index, right.index

    def subtract(self, left: ProgramNode, right: ProgramNode) -> ProgramNode:
        a, b = self.constant(left), self.constant(right)
        if a is not None and b is not None:
            return self.leaf(a - b)
        if a == 0:
            return self.negative(right)
        return left if b == 0 else self._node(("-", left.index, right.index))

    def negative(self, node: ProgramNode) -> ProgramNode:
        if self.constant(node) is not None:
            return self.leaf(-node.value)
        sign, *operands = self.steps[node.index]
        return self.at(*operands) if sign == "negative" else self._node(("negative", node.index))

    def power(self, base: ProgramNode, exponent: int) -> ProgramNode:
        if self.constant(base) is not None:
            return self.leaf(base.value**exponent)
        return base if exponent == 1 else self._node(("**", base.index, self.leaf(exponent).index))

    def expression(self, number: Any) -> Expression:
        """Expression of a number in the parameters of the model."""
        sign, *operands = self.steps[self.node(number).index]
        if sign == "leaf":
            (payload,) = operands
            return Number(payload) if isinstance(payload, Fraction) else payload
        return Compound(sign, tuple(self.expression(self.at(operand)) for operand in operands))


# Names, units and expressions of a model as Modelica writes them.

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
        self.record = WrittenRecord()
        named = {name: self.record.parameter(name, value) for name, value in values.items()}
        self.symbolic: Values = Values(named, self.record.algebra)

    def expression(self, value: Expression) -> str:
        """Modelica text of an expression in SI units; equal to the model's for any values of the parameters."""
        text = _NAME.sub(self._name, value.written()[0].replace("**", "^"))
        return _INTEGER.sub(lambda match: f"{match[0]}.0" if int(match[0]) > LARGEST_INTEGER else match[0], text)

    def _name(self, match: re.Match[str]) -> str:
        known = {"pi": "Modelica.Constants.pi", "sqrt": "sqrt"}
        return known.get(match[0]) or self.names[match[0]]

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
    kinds: dict[str, str] = {}
    for element in elements:
        for _, _, expression, kind in element.expressions():
            for name in expression.names:
                alone = isinstance(expression, Name) and known.get(name) is None
                if alone or (kind in MODELICA_UNITS and known.get(name) == DIMENSIONS[kind]):
                    kinds.setdefault(name, kind)
    return kinds


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


COMPONENTS = f"{ROTATIONAL}.Components"
FIXED = f"node:{GROUND}"

Lever: TypeAlias = tuple[str, ProgramNode]
"""Connection point of a Modelica model, and the factor from its angle to the weighted sum of angles of a row."""


def port(element: Element, name: str) -> str:
    """Name of the connection point at a port of an element, joined to its node or to a torque sensor between them."""
    return f"port:{element.name}.{name}"


def declared(element: Element, net: Net, kind: str, values: str = "", suffix: str = "") -> str:
    """Declare a component of an element and return its name, with the element's description if it has no suffix."""
    comment = quoted(element.description) if element.description and not suffix else ""
    return net.declare(f"{COMPONENTS}.{kind}", element.name + suffix, values, comment)


def write_parts(element: Element, net: Net, words: ModelicaExpressions) -> None:
    """Declare springs, dampers and inertias on the row of each law, and ideal gears or connections for constraints.

    A row of one node, or the difference of two, is acted on as it is. Any other row becomes the angle of a flange: an
    ideal planetary set has the weighted mean of two angles on its carrier.
    """
    writer = _PartWriter(element, net, words)
    for part in element.parts(words.symbolic):
        writer.write(part)


def has_counterpart(part: Part) -> bool:
    """Whether Modelica components can do what a law, constraint or action does: nothing that depends on frequency."""
    if isinstance(part, Action):
        return False
    return isinstance(part, Constraint) or (part.loss_factor == 0 and part.table is None)


class _PartWriter:
    def __init__(self, element: Element, net: Net, words: ModelicaExpressions) -> None:
        self.element, self.net, self.words = element, net, words
        self.points = {node: f"node:{node}" for node in element.internal_nodes}
        for name, node in reversed(element.ports.items()):
            self.points[node] = port(element, name)
        self.is_first = True

    def write(self, part: Part) -> None:
        if isinstance(part, Constraint):
            self._constraint(part.row)
        elif isinstance(part, Law) and part.acts:
            if part.is_elastic or part.damping != 0:
                self._spring(part)
            if part.inertia != 0:
                # The row's sum is the factor times one angle, so that J counts the factor squared.
                point, factor = self._mean(part.row)
                name = self._declared("Inertia", f"J={self._text(part.inertia * factor**2)}", "_inertia")
                self.net.points.join(point, f"{name}.flange_a")

    def _declared(self, kind: str, values: str, suffix: str) -> str:
        name = declared(self.element, self.net, kind, values, "" if self.is_first else suffix)
        self.is_first = False
        return name

    def _text(self, number: Any) -> str:
        return self.words.expression(self.words.record.expression(number))

    def _spring(self, law: Law) -> None:
        first, second, factor = self._ends(law.row)
        # gamma is the factor times a difference of two angles: k and c count its square.
        laws = {"c": law.stiffness * factor**2, "d": law.damping * factor**2}
        values = ", ".join(f"{letter}={self._text(number)}" for letter, number in laws.items() if number != 0)
        kind = "Damper" if law.stiffness == 0 else "Spring" if law.damping == 0 else "SpringDamper"
        name = self._declared(kind, values, f"_{kind.lower()}")
        self.net.points.join(first, f"{name}.flange_a")
        self.net.points.join(second, f"{name}.flange_b")

    def _ends(self, row: Row) -> tuple[str, str, ProgramNode]:
        """Two connection points and a factor, so that their difference of angles times it is the row's sum."""
        nodes = list(row)
        if len(nodes) == 2 and row[nodes[0]] + row[nodes[1]] == 0:
            return self.points[nodes[0]], self.points[nodes[1]], self.words.record.node(row[nodes[0]])
        point, factor = self._mean(row)
        return point, self.points.get(GROUND, FIXED), factor

    def _mean(self, row: Row) -> Lever:
        """Connection point and a factor, such that its angle times it is the weighted sum of a row."""
        levers = [(self.points[node], self.words.record.node(share)) for node, share in row.items()]
        return reduce(self._mean_of_two, levers)

    def _mean_of_two(self, lever: Lever, other: Lever) -> Lever:
        (point, factor), (end, share) = lever, other
        if factor + share == 0:  # there is no mean of weights that cancel: the other angle turned round
            reverse = self._declared("IdealGear", "ratio=-1", "_reverse")
            self.net.points.join(end, f"{reverse}.flange_a")
            end, share = f"{reverse}.flange_b", -share
        # Its equation is sun + r ring = (1 + r) carrier; r = share/factor makes the sum (factor + share) carrier.
        mean = self._declared("IdealPlanetary", f"ratio={self._text(share / factor)}", "_mean")
        self.net.points.join(point, f"{mean}.sun")
        self.net.points.join(end, f"{mean}.ring")
        return f"{mean}.carrier", factor + share

    def _constraint(self, row: Row) -> None:
        *some, last = row
        if not some:
            self._hold(self.points[last])
            return
        point, factor = self._mean({node: row[node] for node in some})
        share = self.words.record.node(row[last])
        # Weights that cancel leave two equal angles.
        if factor + share == 0:
            self.net.points.join(point, self.points[last])
            return
        # factor phi_m + share phi = 0, and an ideal gear has phi_a = ratio phi_b.
        gear = self._declared("IdealGear", f"ratio={self._text(-share / factor)}", "_gear")
        self.net.points.join(point, f"{gear}.flange_a")
        self.net.points.join(self.points[last], f"{gear}.flange_b")

    def _hold(self, point: str) -> None:
        if GROUND in self.points:
            self.net.points.join(point, self.points[GROUND])
        else:
            self.net.points.join(point, f"{self._declared('Fixed', '', '_fixed')}.flange")
