"""Expression, a quantity of a study that is a formula of other quantities."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from types import CodeType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.entries.spec import EntryError, Json, Schema, Spec, Text, entry
from torsionnet.base.errors import Fault, TorsionnetError, UsageError, got, unknown_name
from torsionnet.base.expression_reading import parse_expression
from torsionnet.base.expressions import Algebra, Expression, ExpressionError
from torsionnet.base.units import DIMENSIONS, Dimension, UnitError, parse_unit
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.quantity import QuantityForm, StudyQuantity, VariantBlock, register_quantity

ARRAYS = Algebra(number=float, sqrt=np.sqrt, pi=math.pi)
"""Square root, pi and conversion of numbers by which formulas of quantities calculate with arrays."""


class QuantityFormula(Spec[Expression]):
    """Entry of a study file for a formula of other quantities."""

    def coerce(self, raw: object) -> Expression:
        if isinstance(raw, Expression):
            return raw
        if not isinstance(raw, str):
            raise EntryError(f"expected an expression of other quantities, as f_2/f_1, {got(raw)}", kind="wrong-form")
        try:
            expression = parse_expression(raw)
        except ExpressionError as error:
            raise EntryError(error.fault) from None
        if not expression.names:
            raise EntryError(f'"{raw}" names no quantity', kind="wrong-form")
        return expression

    def plain(self, value: Any) -> Json:
        return str(value)

    def schema(self) -> Schema:
        return {"type": "string", "description": self.description}


@register_quantity
@dataclass(frozen=True, kw_only=True)
class QuantityExpression(StudyQuantity):
    """Quantity by a formula of other quantities of the study, numbers or curves over the same points.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.study.quantities.transfer_quantity import ResponseQuantity
    >>> static = ResponseQuantity(output="theta_1", input="T_T", at="0 Hz")
    >>> asked = {"static": static, "stiffness": QuantityExpression(of="1/static")}
    >>> block = VariantBlock(tn.load("dmf_rig"), {"k_2": np.array([400.0, 500.0])}, asked, None)
    >>> (block.of("stiffness") * block.of("static")).round(12).tolist()
    [[1.0], [1.0]]
    """

    kind: ClassVar[str] = "expression"

    of: Expression = entry(QuantityFormula("numbers, names of quantities, + - * / powers, sqrt and pi"))
    unit: str | None = entry(Text("of what comes out; default: by the units of the quantities"), None)

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        for name in sorted(self.of.names - quantities.keys()):
            yield unknown_name("quantity", name, quantities, ("of",), rest=f"there are {', '.join(quantities)}")
        circle = self.circle(quantities)
        if circle:
            yield Fault(
                f"{' needs '.join(circle)}: quantities go round in a circle", ("of",), kind="circular-definition"
            )
        if circle or not self.has_all(quantities):
            return
        try:
            self.measured(model, quantities)
        except UsageError as error:
            yield replace(error.fault, path=("of",))

    @property
    def parts(self) -> tuple[str, ...]:
        return tuple(sorted(self.of.names))

    def circle(self, quantities: Mapping[str, object], above: tuple[str, ...] = ()) -> tuple[str, ...]:
        """Names of quantities that depend on each other in a circle, the first one twice; empty without a circle."""
        for name in sorted(self.of.names):
            if name in above:
                return (*above[above.index(name) :], name)
            quantity = quantities.get(name)
            circle = quantity.circle(quantities, (*above, name)) if isinstance(quantity, QuantityExpression) else ()
            if circle:
                return circle
        return ()

    def has_all(self, quantities: Mapping[str, StudyQuantity]) -> bool:
        """Whether all quantities in the expression exist, and those in their expressions; there is no circle."""
        if not self.of.names <= quantities.keys():
            return False
        below = [quantities[name] for name in self.of.names]
        return all(quantity.has_all(quantities) for quantity in below if isinstance(quantity, QuantityExpression))

    @property
    def words(self) -> str:
        return str(self.of)

    def measure(self, model: Drivetrain) -> QuantityForm:
        del model
        return QuantityForm(self.unit or "")

    def measured(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> QuantityForm:
        parts = {name: quantities[name].measured(model, quantities) for name in self.of.names}
        curves = [part for part in parts.values() if part.is_curve]
        for curve in curves[1:]:
            if curve.over != curves[0].over or not np.array_equal(curve.points, curves[0].points):
                text = f"{self.of} combines curves over different points"
                raise UsageError(
                    f"{text}; give them the same frequencies or speeds, or take a number of each", kind="unlike-results"
                )
        unit = self._unit(parts) if self.unit is None else self.unit
        return QuantityForm(unit, curves[0].over, curves[0].points) if curves else QuantityForm(unit)

    def _unit(self, parts: Mapping[str, QuantityForm]) -> str:
        try:
            dimension = self.of.dimension({name: _dimension(form.unit) for name, form in parts.items()})
        except ExpressionError as error:
            raise UsageError(error.fault) from None
        return "" if dimension in (None, DIMENSIONS["1"]) else str(dimension)

    def evaluate(self, block: VariantBlock) -> FloatArray:
        circle = self.circle(block.quantities)
        if circle:
            raise UsageError(f"{' needs '.join(circle)}: quantities go round in a circle", kind="circular-definition")
        values = {name: block.of(name) for name in self.of.names}
        with np.errstate(all="ignore"):
            return np.asarray(self.of.evaluate(values, ARRAYS), dtype=float)


def _dimension(unit: str) -> Dimension | None:
    """Dimension of a unit, None if it has none, such as dB; None of a unit without one, such as dB."""
    try:
        return parse_unit(unit).dimension if unit else DIMENSIONS["1"]
    except UnitError:
        return None


# Quantities of a study that are calculated by Python functions of the user, which study files cannot name.

OVER = ("frequency", "speed")


@dataclass(frozen=True, kw_only=True, eq=False)
class UserFunction(StudyQuantity):
    """Quantity that a Python function of the user calculates for every variant, a number or a curve.

    Attributes
    ----------
    of : callable
        ``of(drivetrain) -> number`` or (n_points,) array, SI units.
    unit_of_value : str
    over : str
        Axis of a curve, "frequency" or "speed".
    points : (n_points,) array
        Hz or rad/s.
    """

    kind: ClassVar[str] = "function"
    singly: ClassVar[bool] = True

    of: Callable[[Drivetrain], ArrayLike]
    unit_of_value: str = ""
    over: str = ""
    points: Any = ()

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        del quantities
        value = np.atleast_1d(np.asarray(self.of(model)))
        if value.dtype.kind not in "biuf":
            given = "complex values; take a magnitude, a phase or a part" if value.dtype.kind == "c" else "no numbers"
            yield Fault(f"{self.function_name} gives {given}", kind="wrong-form")
            return
        expected, shape = np.shape(self.points) or (1,), value.shape
        if shape != (expected if self.over else (1,)):
            wanted = expected if self.over else "one number"
            yield Fault(f"{self.function_name} gives values of shape {shape}; expected {wanted}", kind="wrong-form")

    @property
    def words(self) -> str:
        return f"what the function {self.function_name} calculates"

    def measure(self, model: Drivetrain) -> QuantityForm:
        del model
        if not self.over:
            return QuantityForm(self.unit_of_value)
        return QuantityForm(self.unit_of_value, self.over, np.asarray(self.points, dtype=float))

    def evaluate(self, block: VariantBlock) -> FloatArray:
        names = tuple(block.values)

        def of(variant: Drivetrain) -> ArrayLike:
            try:
                return self.of(variant)
            except TorsionnetError:
                raise
            except Exception as error:
                values = ", ".join(f"{name} = {variant.parameters[name]:.9g}" for name in names)
                error.add_note(f"{self.function_name} was asked for the variant {values}")
                raise

        return block.one_by_one(of, len(self.points) if self.over else 1)

    @property
    def function_name(self) -> str:
        """Name of the user's function in messages."""
        return str(getattr(self.of, "__qualname__", self.of))

    def to_data(self) -> dict[str, Json]:
        """Identity of the user's function as JSON data, its name, a digest of its code and of its captured values.

        Functions that it calls, and variables of its module that it reads, are not part of it.
        """
        place = f"{getattr(self.of, '__module__', '')}.{self.function_name}"
        data = {"of": place, "code": _digest(self.of), "unit": self.unit_of_value}
        return data | ({"over": self.over, "points": list(self.points)} if self.over else {})


def _digest(of: Callable[..., Any]) -> str:
    """Digest of a function's code and default values as a text of 16 digits, equal on every machine.

    Empty where it has no code object.
    """
    code = getattr(of, "__code__", None)
    if code is None:
        return ""
    values = [cell.cell_contents for cell in of.__closure__ or ()]
    values += of.__defaults__ or ()
    values += [default for pair in sorted((of.__kwdefaults__ or {}).items()) for default in pair]
    return hashlib.sha256(repr((_essence(code), [_shown(constant) for constant in values])).encode()).hexdigest()[:16]


def _shown(value: Any) -> str:
    """Text of a value that a function was made with, without its address in memory."""
    if callable(value):
        return _digest(value)
    text = repr(value)
    return type(value).__qualname__ if " at 0x" in text else text


def _essence(code: CodeType) -> tuple[Any, ...]:
    """Byte code, names and constants of a function, without file names and line numbers."""
    constants = [_essence(part) if isinstance(part, CodeType) else _in_order(part) for part in code.co_consts]
    return code.co_code, code.co_names, constants


def _in_order(constant: Any) -> Any:
    """Constant of a function in a fixed order, because a set of texts has another order at every start of Python."""
    return sorted(constant, key=repr) if isinstance(constant, frozenset) else constant


def function(
    of: Callable[[Drivetrain], ArrayLike], *, unit: str = "", over: str = "", points: ArrayLike = ()
) -> UserFunction:
    """Make a quantity of a study from a Python function that is called for every variant, one by one.

    Parameters
    ----------
    of : callable
        ``of(drivetrain)`` gives a number, or with ``points`` an array of that length; SI units. An error of this
        package, as for an unknown name, leaves the variant without a value; any other error ends the study.
    unit : str
    over : str
        ``"frequency"`` or ``"speed"`` of a curve.
    points : (n_points,) array
        Hz or rad/s, of a curve.

    Raises
    ------
    UsageError
        Not a function, or a curve without points.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.study.quantities.quantity import VariantBlock
    >>> ratio = function(lambda rig: rig.modes().natural_frequencies[1] / rig.modes().natural_frequencies[0])
    >>> block = VariantBlock(tn.load("dmf_rig"), {"k_2": np.array([460.0])}, {}, None)
    >>> ratio.evaluate(block).round(4).tolist()
    [[11.3977]]
    """
    if not callable(of):
        raise UsageError(f"expected a function of a drivetrain, got {of!r}", kind="wrong-form")
    if over not in ("", *OVER) or bool(over) != bool(np.size(points)):
        raise UsageError(
            "a curve needs its points and over='frequency' or over='speed'; a number has neither", kind="missing-entry"
        )
    return UserFunction(of=of, unit_of_value=unit, over=over, points=tuple(np.ravel(np.asarray(points)).tolist()))
