"""Order torque, a quantity of a study, the vibration of a torque, twist or stress over the machinery's speeds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from math import isclose
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Flag, OneOf, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.dynamic_stiffness.transfer_request import named_output
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.study.quantities.largest_orders import largest_orders, order_responses
from torsionnet.study.quantities.quantity import QuantityForm, StudyQuantity, register_quantity
from torsionnet.study.quantities.speed_quantity import SpeedQuantity
from torsionnet.study.quantities.transfer_quantity import usage_faults
from torsionnet.study.quantities.variant_block import VariantBlock

SIZES: Mapping[str, Callable[[OrderResponse], FloatArray]] = {
    "half_range": lambda run: run.half_range[:, 0],
    "peak": lambda run: run.peak[:, 0],
    "rms": lambda run: run.rms[:, 0],
}

WORDS = {"half_range": "half of the range", "peak": "largest distance from the mean", "rms": "root mean square"}


@register_quantity
@dataclass(frozen=True, kw_only=True)
class OrderTorque(SpeedQuantity):
    """Vibration of a sensor in SI under the model's excitations, all orders summed with their phases, or one of them.

    The largest over the model's speeds, between those of a range too, or a curve over them. A stress is asked for as
    ``stress(shaft)``.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...     tn.Spring("shaft", nodes=("a", "b"), stiffness="k")]
    >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["600 rpm"]}, parameters={"k": 1e4},
    ...     excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}})
    >>> block = VariantBlock(fan, {"k": np.array([1e4, 2e4])}, {}, None)
    >>> found = OrderTorque(output="torque(shaft)").evaluate(block)
    >>> w = 2 * fan.definition.speeds.values[0]
    >>> bool(abs(found[1, 0] - abs(10 * 4e4 / (6e4 - 2 * w**2))) < 1e-9)
    True
    """

    kind: ClassVar[str] = "order_torque"

    output: str = entry(Text("sensor, torque(element), stress(shaft), ..."))
    order: float | None = entry(Value("one order of its shaft instead of the sum", "1", exclusive=True), None)
    size: str | None = entry(
        OneOf("of the sum: half of its range, largest distance from the mean, root mean square", tuple(SIZES)), None
    )
    curve: bool = entry(Flag("whether every speed is asked for, not the largest over them"), False)

    def contradictions(self) -> list[Fault]:
        if self.order is not None and self.size is not None:
            return [Fault("one order has its amplitude; leave out size", ("size",), on_key=True)]
        return []

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        del quantities
        found = [*usage_faults(lambda: named_output(model, self.output), "output"), *self.empty_range_faults(model)]
        yield from found or usage_faults(lambda: self._of(self._alone(model)), *(("order",) if self.order else ()))

    @property
    def words(self) -> str:
        what = WORDS[self.size or "half_range"] if self.order is None else f"amplitude of order {self.order:g}"
        return f"{what} of {self.output} {self.range_words}" + (", one by one" if self.curve else ", the largest")

    def measure(self, model: Drivetrain) -> QuantityForm:
        unit = named_output(model, self.output).unit
        return QuantityForm(unit, "speed", self.at(model)) if self.curve else QuantityForm(unit)

    def evaluate(self, block: VariantBlock) -> FloatArray:
        speeds, acting = self.at(block.model), self.excitations or None
        found = np.full((len(block), len(speeds) if self.curve else 1), np.nan)
        if self.is_range(block.model) and not self.curve:
            for index, largest in largest_orders(block, self.output, speeds, acting, self._sizes):
                found[index] = largest
            return found
        for index, run in order_responses(block, self.output, speeds, acting):
            found[index] = self._of(run)
        return found

    def _alone(self, model: Drivetrain) -> OrderResponse:
        """Order response of the nominal model at its first speed, for the faults that any speed would have."""
        speeds = self.at(model)
        return model.order_response(
            self.output, speeds=speeds[:1] if len(speeds) else None, excitations=self.excitations or None
        )

    def _of(self, run: OrderResponse) -> FloatArray:
        sizes = self._sizes(run)
        return sizes if self.curve else sizes.max(keepdims=True)

    def _sizes(self, run: OrderResponse) -> FloatArray:
        return SIZES[self.size or "half_range"](run) if self.order is None else self._of_one(run)

    def _of_one(self, run: OrderResponse) -> FloatArray:
        """Largest amplitude of one order at each speed (n_speeds,) in SI, over all phases between excitations."""
        assert self.order is not None
        cases = [case.amplitude_of_order(self.order) for case in run.case_responses]
        lines = [place for place, line in enumerate(run.lines) if not line.fixed and isclose(line.order, self.order)]
        if len(lines) == 1:
            cases.append(run.sizes[:, lines[0], 0])
        return np.asarray(np.max(cases, axis=0))
