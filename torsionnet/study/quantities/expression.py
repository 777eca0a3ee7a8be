"""Expression, a quantity of a study that is a formula of other quantities."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.spec import EntryError, Json, Schema, Spec, Text, entry
from torsionnet.base.errors import Fault, UsageError, got, unknown_name
from torsionnet.base.expression_reading import parse_expression
from torsionnet.base.expressions import Algebra, Expression, ExpressionError
from torsionnet.base.units import DIMENSIONS, Dimension, UnitError, parse_unit
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.quantity import QuantityForm, StudyQuantity, register_quantity
from torsionnet.study.quantities.variant_block import VariantBlock

ARRAYS = Algebra(number=float, sqrt=np.sqrt, pi=math.pi)
"""Square root, pi and conversion of numbers by which formulas of quantities calculate with arrays."""


class QuantityFormula(Spec[Expression]):
    """Entry of a study file for a formula of other quantities."""

    def coerce(self, raw: object) -> Expression:
        if isinstance(raw, Expression):
            return raw
        if not isinstance(raw, str):
            raise EntryError(f"expected an expression of other quantities, as f_2/f_1, {got(raw)}")
        try:
            found = parse_expression(raw)
        except ExpressionError as error:
            raise EntryError(str(error)) from None
        if not found.names:
            raise EntryError(f'"{raw}" names no quantity')
        return found

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
    >>> from torsionnet.study.quantities.response import ResponseQuantity
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
            yield Fault(f"{' needs '.join(circle)}: quantities go round in a circle", ("of",))
        if circle or not self.has_all(quantities):
            return
        try:
            self.measured(model, quantities)
        except UsageError as error:
            yield Fault(str(error), ("of",))

    @property
    def parts(self) -> tuple[str, ...]:
        return tuple(sorted(self.of.names))

    def circle(self, quantities: Mapping[str, object], above: tuple[str, ...] = ()) -> tuple[str, ...]:
        """Names of quantities that depend on each other in a circle, the first one twice; empty without a circle."""
        for name in sorted(self.of.names):
            if name in above:
                return (*above[above.index(name) :], name)
            one = quantities.get(name)
            found = one.circle(quantities, (*above, name)) if isinstance(one, QuantityExpression) else ()
            if found:
                return found
        return ()

    def has_all(self, quantities: Mapping[str, StudyQuantity]) -> bool:
        """Whether all quantities in the expression exist, and those in their expressions; there is no circle."""
        if not self.of.names <= quantities.keys():
            return False
        below = [quantities[name] for name in self.of.names]
        return all(one.has_all(quantities) for one in below if isinstance(one, QuantityExpression))

    @property
    def words(self) -> str:
        return str(self.of)

    def measure(self, model: Drivetrain) -> QuantityForm:
        del model
        return QuantityForm(self.unit or "")

    def measured(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> QuantityForm:
        parts = {name: quantities[name].measured(model, quantities) for name in self.of.names}
        curves = [one for one in parts.values() if one.is_curve]
        for one in curves[1:]:
            if one.over != curves[0].over or not np.array_equal(one.points, curves[0].points):
                text = f"{self.of} combines curves over different points"
                raise UsageError(f"{text}; give them the same frequencies or speeds, or take a number of each")
        unit = self._unit(parts) if self.unit is None else self.unit
        return QuantityForm(unit, curves[0].over, curves[0].points) if curves else QuantityForm(unit)

    def _unit(self, parts: Mapping[str, QuantityForm]) -> str:
        try:
            found = self.of.dimension({name: _dimension(one.unit) for name, one in parts.items()})
        except ExpressionError as error:
            raise UsageError(str(error)) from None
        return "" if found in (None, DIMENSIONS["1"]) else str(found)

    def evaluate(self, block: VariantBlock) -> FloatArray:
        circle = self.circle(block.quantities)
        if circle:
            raise UsageError(f"{' needs '.join(circle)}: quantities go round in a circle")
        values = {name: block.of(name) for name in self.of.names}
        with np.errstate(all="ignore"):
            return np.asarray(self.of.evaluate(values, ARRAYS), dtype=float)


def _dimension(unit: str) -> Dimension | None:
    """Dimension of a unit, None if it has none, such as dB; None of a unit without one, such as dB."""
    try:
        return parse_unit(unit).dimension if unit else DIMENSIONS["1"]
    except UnitError:
        return None
