"""Parameters of a model, values with units, expressions of others, or tables over the operating point.

Here as well: entry for tables of numbers over a key, as of parameters over speed or torque: ``{key: value}``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any, ClassVar

from torsionnet.base.entries.composite import Nested, superfluous
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import AnyQuantity, Value, plain_scalar, read_scalar
from torsionnet.base.entries.spec import (
    EntryError,
    Json,
    OneOf,
    Plural,
    Schema,
    Spec,
    Text,
    coerce_part,
    entry,
    reference,
)
from torsionnet.base.errors import Fault, got, message_of, named_list
from torsionnet.base.expressions import Expression, ExpressionError, Number, Rows
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.base.registers import settle
from torsionnet.base.units import DIMENSIONS, Dimension
from torsionnet.model.element_base.element_entries import ElementName, NodeText


class LookupTable(Plural[Rows]):
    """Entry for a table of numbers over a key in rising order.

    ``{100 rpm: 25 kN*m*s/rad, 150 rpm: 37 kN*m*s/rad}`` is stored as pairs.
    """

    is_read_off: ClassVar[bool] = True

    absent: ClassVar[Any] = ()

    @property
    def example(self) -> str:
        return "{100 rpm: 25 kN*m*s/rad, 150 rpm: 37 kN*m*s/rad}"

    def read(self, raw: object) -> tuple[Rows, list[Fault]]:
        if isinstance(raw, tuple) and all(isinstance(row, tuple) and isinstance(row[0], Number) for row in raw):
            return raw, []
        if not isinstance(raw, Mapping) or len(raw) < 2:
            return (), [Fault(f"expected two rows or more, as in {self.example}; {got(raw)}", kind="wrong-form")]
        rows: list[tuple[Number, Number]] = []
        faults: list[Fault] = []
        for key, value in raw.items():
            try:
                rows.append((self.key(key), self.value(value)))
            except EntryError as error:
                faults.append(replace(error.fault, path=(key,)))
        rows.sort(key=lambda row: row[0].value)
        twice = [second for first, second in pairwise(rows) if first[0].value == second[0].value]
        faults += [Fault(f"{key} stands twice in the table; keep one row", kind="repeated-name") for key, _ in twice]
        faults += self.unit_faults(rows)
        return ((), faults) if faults else (tuple(rows), [])

    def key(self, raw: object) -> Number:
        """Number with its unit that is the key of a table row."""
        return _number(raw)

    def value(self, raw: object) -> Number:
        """Number with its unit that is the value of a table row."""
        return _number(raw)

    def unit_faults(self, rows: list[tuple[Number, Number]]) -> list[Fault]:
        """Faults of table rows that have units of different kinds."""
        if len({value.unit_dimension for _, value in rows}) > 1:
            return [Fault("the values of a table must have units of one kind", kind="wrong-unit")]
        return []

    def plain(self, value: Any) -> Json:
        return {str(key): plain_scalar(number) for key, number in value}

    def schema(self) -> Schema:
        return {
            "type": "object",
            "description": self.description,
            "minProperties": 2,
            "additionalProperties": reference("scalar"),
        }

    @property
    def accepted(self) -> str:
        return "NumberByNumber"


def _number(raw: object) -> Number:
    value = read_scalar(raw)
    if not isinstance(value, Number):
        raise EntryError(
            f'expected a number with unit; "{raw}" is an expression of parameters', kind="expression-not-allowed"
        )
    return value


def wrong_key(rows: Rows, wanted: Dimension) -> Number | None:
    """First key of a table that has another dimension or is below zero, or None."""
    return next((key for key, _ in rows if key.unit_dimension not in (None, wanted) or key.value < 0), None)


VIBRATORY_TORQUE = "vibratory_torque"
FOLLOWED_QUANTITIES = {
    "speed": ("a node", "speed"),
    "load": ("a node that drives or absorbs", "torque"),
    "mean_torque": ("an element", "torque"),
    VIBRATORY_TORQUE: ("an element", "torque"),
}
"""Kind of thing and dimension of each quantity of the operating point that a parameter may follow, by quantity."""


_FOLLOWED = {
    "a node": NodeText("the node it follows"),
    "a node that drives or absorbs": NodeText("the node it follows"),
    "an element": ElementName("the element it follows"),
}


class OperatingValue(Number):
    """Number in SI units that a parameter has at the operating point."""


class Bounds(tuple[float, float]):
    """Lower and upper bound of a parameter in SI, with the dimensions in which they are written (None where bare)."""

    dimensions: tuple[Dimension | None, ...] = ()


class BoundsEntry(Spec[Bounds]):
    """Entry for a lower and an upper bound of a parameter."""

    def coerce(self, raw: object) -> Bounds:
        if isinstance(raw, Bounds):
            return raw
        if not isinstance(raw, list | tuple) or len(raw) != 2:
            raise EntryError(f"bounds are [lower, upper], {got(raw)}", kind="wrong-form")
        ends = [coerce_part(index, _BOUND, end) for index, end in enumerate(raw)]
        if ends[0].value >= ends[1].value:
            raise EntryError("the lower bound must be smaller than the upper bound", kind="unordered-rows")
        bounds = Bounds((float(ends[0].value), float(ends[1].value)))
        bounds.dimensions = tuple(end.unit_dimension for end in ends)
        return bounds

    def plain(self, value: Any) -> list[float]:
        return list(value)

    def schema(self) -> Schema:
        return {
            "type": "array",
            "items": reference("scalar"),
            "minItems": 2,
            "maxItems": 2,
            "description": self.description,
        }


class Bound(Spec[Number]):
    """Entry for one bound of a parameter: a number with or without unit."""

    def coerce(self, raw: object) -> Number:
        value = read_scalar(raw)
        if not isinstance(value, Number):
            raise EntryError("a bound must be a number or a quantity, not an expression", kind="expression-not-allowed")
        return value


_BOUND = Bound("a bound")


@dataclass(frozen=True)
class Parameter(Declared):
    """A named value.

    ``value`` is a number, a quantity or an expression of other parameters; ``bounds`` (lower, upper) in SI say what is
    plausible and limit fits; ``tolerance`` is the share by which an assumed value may be off.
    """

    kind: ClassVar[str] = "parameter"
    article: ClassVar[str] = "a parameter"

    value: Expression = entry(  # type: ignore[assignment]  # None only until the parameter is made
        AnyQuantity("a number in SI units, a value with unit, or an expression of parameters"), None
    )
    description: str = entry(Text("what the parameter is"), "")
    bounds: tuple[float, float] | None = entry(BoundsEntry("[lower, upper]: what is plausible; limits of a fit"), None)
    tolerance: float | None = entry(
        Value(
            "how far an assumed value may be off, as 10 % of it; reports say what that moves",
            "1",
            exclusive=True,
            below=1,
        ),
        None,
    )
    by: str | None = entry(
        OneOf("instead of a value: the part of the operating point it follows", tuple(FOLLOWED_QUANTITIES)), None
    )
    of: str = entry(Text("the node or element of the operating point it follows"), "")
    table: Rows = entry(LookupTable("values over that, without sign; default: the speed or torque itself"), None)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.by is not None and self.value is None:
            dimension = DIMENSIONS[FOLLOWED_QUANTITIES[self.by][1]]
            first = self.table[0][1] if self.table else Number(1, dimension)
            settle(self, value=OperatingValue(first.value, first.unit_dimension))

    def contradictions(self) -> list[Fault]:
        if self.by is None:
            extra = [key for key in ("of", "table") if getattr(self, key)]
            if extra:
                return [
                    Fault(
                        f"{extra[0]} needs by: {' or '.join(FOLLOWED_QUANTITIES)}",
                        (extra[0],),
                        on_key=True,
                        kind="missing-entry",
                    )
                ]
            return [self.missing("value")] if self.value is None else []
        if self.value is not None and not isinstance(self.value, OperatingValue):
            return [superfluous(f"a parameter by {self.by} has no value of its own", "value")]
        what, dimension = FOLLOWED_QUANTITIES[self.by]
        if not self.of:
            return [Fault(f"by: {self.by} needs of: the name of {what}", on_key=True, kind="missing-entry")]
        if self.by == VIBRATORY_TORQUE and not self.table:
            return [Fault(f"by: {self.by} needs a table", on_key=True, kind="missing-entry")]
        wrong = wrong_key(self.table, DIMENSIONS[dimension])
        if wrong is not None:
            text = f"the rows of a table by {self.by} begin with a {dimension} from 0 on, not {wrong}"
            return [Fault(text, ("table",), on_key=True, kind="wrong-unit")]
        return []

    @property
    def is_derived(self) -> bool:
        return bool(self.value.names)

    @property
    def written(self) -> str:
        """Text of the value or expression of the parameter, or of the quantity that it follows."""
        return str(self.value) if self.by is None else f"by {self.by.replace('_', ' ')} of {self.of}"

    def given(self, value: Expression) -> Parameter:
        """Copy of the parameter with a fixed value in place of its expression or table."""
        return replace(self, value=value, by=None, of="", table=())

    @classmethod
    def spec_beside(cls, name: str, spec: Spec[Any], entries: Mapping[str, Any]) -> Spec[Any]:
        if name != "of" or entries.get("by") not in FOLLOWED_QUANTITIES:
            return spec
        return _FOLLOWED[FOLLOWED_QUANTITIES[entries["by"]][0]]

    def with_operating_values(self, value: float) -> Parameter:
        """Copy of the parameter with its value in SI units at an operating point."""
        return replace(self, value=OperatingValue(value, getattr(self.value, "unit_dimension", None)))

    def to_data(self) -> Json:
        """Entry of the parameter as a model file has it: the value alone if the parameter has nothing else."""
        data = self.written_entries()
        if self.by is not None:
            del data["value"]
        return data["value"] if list(data) == ["value"] else data


PARAMETER = Nested("a value, or a value with more about it", lambda: Parameter, "parameter", shorthand="value")


def evaluation_order(parameters: Mapping[str, Parameter]) -> tuple[list[str], list[list[str]]]:
    """Names of parameters in the order in which they are evaluated, and the cycles among them."""
    order: list[str] = []
    cycles: list[list[str]] = []
    done: dict[str, bool] = {}
    for start in parameters:
        # Depth first, without recursion: a chain of parameters may be longer than Python's stack.
        stack: list[tuple[str, Iterator[str]]] = []
        if start not in done:
            stack, done[start] = [(start, iter(sorted(parameters[start].value.names)))], False
        while stack:
            name, uses = stack[-1]
            used = next(uses, None)
            if used is None:
                stack.pop()
                done[name] = True
                order.append(name)
            elif used in parameters and used not in done:
                done[used] = False
                stack.append((used, iter(sorted(parameters[used].value.names))))
            elif done.get(used) is False:
                path = [entry for entry, _ in stack]
                cycles.append(path[path.index(used) :])
    return order, cycles


def resolve(parameters: Mapping[str, Parameter]) -> tuple[dict[str, Fraction | float], list[Fault]]:
    """Value in SI units of every parameter, by name, and faults of cycles, undefined names and arithmetic."""
    order, cycles = evaluation_order(parameters)
    faults = [
        Fault(
            phrase(
                "parameters define each other in a circle: {}; give one of them a value",
                named_list([*cycle, cycle[0]], between=" -> "),
            ),
            ("parameters", cycle[0]),
            kind="circular-definition",
        )
        for cycle in cycles
    ]
    values: dict[str, Fraction | float] = {}
    for name in order:
        expression = parameters[name].value
        if not expression.names <= values.keys():
            continue
        try:
            values[name] = expression.evaluate(values)
        except ExpressionError as error:
            causes = (name, *sorted(expression.names))
            text = phrase("{} cannot be calculated: {}", ModelName(name), message_of(error))
            faults.append(Fault(text, ("parameters", name), causes=causes, kind="incalculable-value"))
    return values, faults


def dimensions(parameters: Mapping[str, Parameter]) -> tuple[dict[str, Dimension | None], list[Fault]]:
    """Dimension of every parameter by name, and faults of sums of unlike quantities.

    None is a bare number, which fits anywhere.
    """
    order, cycles = evaluation_order(parameters)
    known: dict[str, Dimension | None] = {name: None for cycle in cycles for name in cycle}
    faults: list[Fault] = []
    for name in (name for name in order if name not in known):
        try:
            known[name] = parameters[name].value.dimension(known)
        except ExpressionError as error:
            faults.append(replace(error.fault, path=("parameters", name)))
            known[name] = None
    return known, faults
