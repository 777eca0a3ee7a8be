"""Named parameters: values with units, or expressions of other parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from torsionnet.core.errors import Fault, unknown_key
from torsionnet.core.expressions import Expression, ExpressionError, Number, check_name, scalar
from torsionnet.core.units import Dimension, UnitError
from torsionnet.model.elements.fields import FieldError, plain_scalar

KEYS = ("value", "description", "bounds")


@dataclass(frozen=True)
class Parameter:
    """A named value.

    ``value`` is a number, a quantity or an expression of other parameters; ``bounds`` (lower, upper) in SI say what is
    plausible and limit fits.
    """

    value: Any
    description: str = ""
    bounds: tuple[float, float] | None = None
    bound_dimensions: tuple[Dimension | None, ...] = field(default=(), compare=False)
    """Of the bounds as they were written; None of a bare number."""

    def __post_init__(self) -> None:
        if not isinstance(self.value, Expression):
            object.__setattr__(self, "value", read_value(self.value))

    @property
    def is_derived(self) -> bool:
        return bool(self.value.names)

    def to_data(self) -> Any:
        value = plain_scalar(self.value)
        extra: dict[str, Any] = {}
        if self.description:
            extra["description"] = self.description
        if self.bounds is not None:
            extra["bounds"] = list(self.bounds)
        return {"value": value, **extra} if extra else value


def read_value(raw: Any) -> Expression:
    """A parameter's value: any dimension, the checks compare it with the places of use."""
    if raw is None or isinstance(raw, (Mapping, list, tuple)):
        msg = f"expected a number, a quantity with unit or an expression, got {'nothing' if raw is None else repr(raw)}"
        raise FieldError(msg)
    try:
        return scalar(raw)
    except (ExpressionError, UnitError, TypeError, ValueError) as error:
        raise FieldError(str(error)) from None


def read_parameter(raw: Any) -> Parameter:
    """Parameter from a value, or from ``{value: ..., description: ..., bounds: [low, high]}``."""
    if isinstance(raw, Parameter):
        return raw
    if not isinstance(raw, Mapping):
        return Parameter(read_value(raw))
    for key in raw:
        if key not in KEYS:
            # A comma in a description without quotes makes such a key.
            comma = "text with a comma needs quotes; " if raw[key] is None else ""
            raise FieldError(unknown_key(key, KEYS, (key,), f"{comma}a parameter has {', '.join(KEYS)}"))
    if "value" not in raw:
        msg = "a parameter needs a value: {value: 0.46 kN*m/rad, description: ...}"
        raise FieldError(msg)
    try:
        value = read_value(raw["value"])
    except FieldError as error:
        raise FieldError(error.fault.under("value")) from None
    description = raw.get("description", "")
    if not isinstance(description, str):
        msg = f"expected text, got {description!r}"
        raise FieldError(msg, ("description",))
    return Parameter(value, description, *_bounds(raw.get("bounds")))


def _bounds(raw: Any) -> tuple[tuple[float, float] | None, tuple[Dimension | None, ...]]:
    if raw is None:
        return None, ()
    if not isinstance(raw, (list, tuple)) or len(raw) != 2:  # noqa: PLR2004
        msg = f"bounds are [lower, upper], got {raw!r}"
        raise FieldError(msg, ("bounds",))
    ends: list[float] = []
    kinds: list[Dimension | None] = []
    for index, end in enumerate(raw):
        try:
            number = read_value(end)
        except FieldError as error:
            raise FieldError(error.fault.under("bounds", index)) from None
        if not isinstance(number, Number):
            msg = "a bound is a number or a quantity, no expression"
            raise FieldError(msg, ("bounds", index))
        ends.append(float(number.value))
        kinds.append(number.unit_dimension)
    if ends[0] >= ends[1]:
        msg = "the lower bound must be smaller than the upper bound"
        raise FieldError(msg, ("bounds",))
    return (ends[0], ends[1]), tuple(kinds)


def read_parameters(raw: Mapping[str, Any]) -> tuple[dict[str, Parameter], list[Fault]]:
    """All parameters that can be read, and the faults of the others."""
    parameters: dict[str, Parameter] = {}
    faults: list[Fault] = []
    for name, value in raw.items():
        reason = check_name(name)
        if reason:
            faults.append(Fault(reason, ("parameters", name), on_key=True))
            continue
        try:
            parameters[name] = read_parameter(value)
        except FieldError as error:
            faults.append(error.fault.under("parameters", name))
    return parameters, faults


def evaluation_order(parameters: Mapping[str, Parameter]) -> tuple[list[str], list[list[str]]]:
    """Names so that each comes after those it uses, and the cycles found on the way."""
    order: list[str] = []
    cycles: list[list[str]] = []
    state: dict[str, int] = {}
    for start in parameters:
        _visit(start, parameters, state, order, cycles)
    return order, cycles


def _visit(
    start: str, parameters: Mapping[str, Parameter], state: dict[str, int], order: list[str], cycles: list[list[str]]
) -> None:
    """Depth first without recursion: a chain of a thousand derived parameters is fine. State 1: open, 2: done."""
    if start in state:
        return
    stack: list[tuple[str, Iterator[str]]] = [(start, iter(sorted(parameters[start].value.names)))]
    state[start] = 1
    while stack:
        name, uses = stack[-1]
        used = next(uses, None)
        if used is None:
            stack.pop()
            state[name] = 2
            order.append(name)
        elif used in parameters and used not in state:
            state[used] = 1
            stack.append((used, iter(sorted(parameters[used].value.names))))
        elif state.get(used) == 1:
            path = [entry for entry, _ in stack]
            cycles.append(path[path.index(used) :])


def resolve(parameters: Mapping[str, Parameter]) -> tuple[dict[str, Fraction | float], list[Fault]]:
    """Value in SI of every parameter that has one; faults for cycles, undefined names and impossible arithmetic."""
    order, cycles = evaluation_order(parameters)
    faults = [
        Fault(f"parameters define each other in a circle: {' -> '.join([*cycle, cycle[0]])}", ("parameters", cycle[0]))
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
            faults.append(Fault(f"{name} cannot be calculated: {error}", ("parameters", name)))
    return values, faults


def dimensions(parameters: Mapping[str, Parameter]) -> tuple[dict[str, Dimension | None], list[Fault]]:
    """Dimension of every parameter (None: a bare number, fits anywhere); faults for sums of unlike quantities."""
    order, cycles = evaluation_order(parameters)
    found: dict[str, Dimension | None] = {name: None for cycle in cycles for name in cycle}
    faults: list[Fault] = []
    for name in (name for name in order if name not in found):
        try:
            found[name] = parameters[name].value.dimension(found)
        except ExpressionError as error:
            faults.append(Fault(str(error), ("parameters", name)))
            found[name] = None
    return found, faults
