"""Unknowns of a calculation, which are named parameters or fields of elements such as ``oil.damping``."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from torsionnet.base.entries.scalars import QuantityKind
from torsionnet.base.errors import ModelError, UsageError, did_you_mean
from torsionnet.base.expressions import Algebra, ExpressionError, Name, Number
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.model.damping import DampingMeasure
from torsionnet.model.definition import Definition
from torsionnet.model.elements import Element
from torsionnet.model.parameters import Parameter, evaluation_order

# Dual numbers, which carry derivatives, so that elements evaluate the derivatives of their own laws.


@dataclass(frozen=True, eq=False, slots=True)
class Dual:
    """Dual number, which is a value and its gradient (n_p,) to the varied parameters.

    It equals a plain number only if its gradient is zero.

    >>> x = Dual(3.0, np.array([1.0]))
    >>> y = 1 / x**2 - x
    >>> round(float(y.value), 6), (y.gradient * 27).round(9).tolist()
    (-2.888889, [-29.0])
    """

    value: Fraction | float
    gradient: FloatArray

    def __add__(self, other: Any) -> Dual:
        if isinstance(other, Dual):
            return Dual(self.value + other.value, self.gradient + other.gradient)
        return Dual(self.value + other, self.gradient)

    def __mul__(self, other: Any) -> Dual:
        if isinstance(other, Dual):
            moved = float(self.value) * other.gradient + float(other.value) * self.gradient
            return Dual(self.value * other.value, moved)
        return Dual(self.value * other, self.gradient * float(other))

    def __truediv__(self, other: Any) -> Dual:
        if isinstance(other, Dual):
            quotient = self.value / other.value
            return Dual(quotient, (self.gradient - float(quotient) * other.gradient) / float(other.value))
        return Dual(self.value / other, self.gradient / float(other))

    def __rtruediv__(self, other: Any) -> Dual:
        quotient = other / self.value
        return Dual(quotient, self.gradient * (-float(quotient) / float(self.value)))

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.gradient)

    def __sub__(self, other: Any) -> Dual:
        return self.__add__(-other)

    def __rsub__(self, other: Any) -> Dual:
        return (-self).__add__(other)

    def __pow__(self, power: Any) -> Dual:
        slope = float(power) * float(self.value) ** (float(power) - 1)
        return Dual(self.value**power, self.gradient * slope)

    __radd__ = __add__
    __rmul__ = __mul__

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Dual):
            return bool(self.value == other.value) and bool(np.array_equal(self.gradient, other.gradient))
        return bool(self.value == other) and not self.gradient.any()

    def __lt__(self, other: Any) -> bool:
        return bool(self.value < value_of(other))

    def __gt__(self, other: Any) -> bool:
        return bool(self.value > value_of(other))

    def __hash__(self) -> int:
        return hash(self.value)

    def __float__(self) -> float:
        return float(self.value)


def _root(number: Any) -> Any:
    root = math.sqrt(float(number))
    if not isinstance(number, Dual):
        return root
    # The root of a square that vanishes has a kink, not a pole: its derivative is the mean of both sides.
    at_kink = root == 0 and not number.gradient.any()
    return Dual(root, number.gradient if at_kink else number.gradient / (2 * root))


DUALS = Algebra(number=Fraction, sqrt=_root, pi=math.pi)
"""Arithmetic for expressions in which some parameters are a :class:`Dual`, so that results carry derivatives."""


def gradient_of(number: Any, count: int) -> FloatArray:
    """Derivatives (count,) that a dual number carries, zeros for any other number."""
    return number.gradient if isinstance(number, Dual) else np.zeros(count)


def value_of(number: Any) -> Any:
    """Value of a dual number without its derivatives, or any other number as it is."""
    return number.value if isinstance(number, Dual) else number


@dataclass(frozen=True)
class Unknowns:
    """Parameters and fields of elements of a drivetrain that are varied, with their present values in SI units.

    Attributes
    ----------
    names : tuple of str
        As the caller named them.
    parameters : tuple of str
        The parameters of ``definition`` that hold them.
    start : tuple of float
        Their values in the drivetrain, SI.
    definition : Definition
        With a parameter for every field that was named by its element.
    """

    names: tuple[str, ...]
    parameters: tuple[str, ...]
    start: tuple[float, ...]
    definition: Definition

    def values(self, at: Sequence[float]) -> dict[str, Any]:
        """Values in SI units of all parameters by name, as dual numbers where they depend on the unknowns.

        Raises
        ------
        ModelError
            A value cannot be calculated there.
        """
        gradients = np.eye(len(self.names))
        varied = {
            name: Dual(float(x), gradients[i]) for i, (name, x) in enumerate(zip(self.parameters, at, strict=True))
        }
        values: dict[str, Any] = {}
        for name in evaluation_order(self.definition.parameters)[0]:
            try:
                values[name] = varied[name] if name in varied else self._evaluated(name, values)
            except (ExpressionError, ZeroDivisionError) as error:
                raise ModelError(f"{name} cannot be calculated: {error}", kind="incalculable-value") from None
        return values

    def _evaluated(self, name: str, values: Mapping[str, Any]) -> Any:
        return self.definition.parameters[name].value.value_in(values, DUALS)


def unknowns(drivetrain: AssembledModel, names: Sequence[str]) -> Unknowns:
    """Unknowns of a drivetrain, with present values in SI units, from names of parameters or fields.

    Raises
    ------
    UsageError
        A name means nothing, is given twice, or is a field without a plain value.

    Examples
    --------
    >>> import torsionnet as tn
    >>> unknowns(tn.load("dmf_rig"), ["c_2", "k_2"]).start
    (4.0, 460.0)
    """
    definition = drivetrain.definition
    parameters, start = [], []
    strange = [name for name in names if not isinstance(name, str)]
    if strange:
        raise UsageError(f"a parameter must be given by its name, got {strange[0]!r}", kind="wrong-form")
    twice = sorted({name for name in names if list(names).count(name) > 1})
    if twice:
        raise UsageError(f"{', '.join(twice)} is named twice; name each parameter once", kind="repeated-name")
    for name in names:
        if name in definition.parameters:
            parameters.append(name)
            start.append(float(drivetrain.exact_values[name]))
            continue
        definition, parameter = _with_parameter(definition, name, drivetrain)
        parameters.append(parameter)
        start.append(float(definition.parameters[parameter].value.evaluate(drivetrain.exact_values)))
    if definition.tangents is not None:
        definition = replace(definition, tangents=definition.tangents.of(definition))
    return Unknowns(tuple(names), tuple(parameters), tuple(start), definition)


def _with_parameter(definition: Definition, name: str, drivetrain: AssembledModel) -> tuple[Definition, str]:
    """Definition with a parameter in place of the number ``element.field``, and the parameter's name."""
    element_name, _, field = name.rpartition(".")
    if element_name not in definition.elements:
        known = [*definition.parameters, *(f"{e}.{f}" for e in definition.elements for f in _fields(drivetrain, e))]
        raise UsageError(
            f'no parameter is named "{name}"{did_you_mean(name, known)}; or name a field: element.stiffness',
            kind="unknown-parameter",
        )
    element = definition.elements[element_name]
    known_fields = _fields(drivetrain, element_name)
    if field not in known_fields:
        has = ", ".join(known_fields) or "none"
        raise UsageError(
            f'{element_name} has no number "{field}"{did_you_mean(field, known_fields)} to vary; it has {has}',
            kind="unknown-entry",
        )
    value = getattr(element, field)
    if isinstance(value, DampingMeasure) or not isinstance(value, Number):
        raise UsageError(
            f"{name} is given as {value}; vary the parameters in it, or give it a plain value",
            kind="expression-not-allowed",
        )
    # The number becomes a parameter of that value, and is varied as any other.
    parameter = f"{element_name}__{field}"
    varied: Any = {field: Name(parameter)}
    changed: Element = replace(element, **varied)
    return (
        replace(
            definition,
            elements={**definition.elements, element_name: changed},
            parameters={**definition.parameters, parameter: Parameter(value, "", None)},
        ),
        parameter,
    )


def _fields(drivetrain: AssembledModel, element: str) -> list[str]:
    """Names of the fields of an element that hold a single number and have a value."""
    scalars = drivetrain.definition.elements[element].scalars()
    return [name for name, (spec, _) in scalars.items() if isinstance(spec, QuantityKind)]
