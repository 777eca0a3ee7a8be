"""Base class of a study's quantities of one transfer function, which have an output, input and excitation."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.spec import Count, Text, entry
from torsionnet.base.errors import Fault, UsageError
from torsionnet.base.units import RPM
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.transfer_request import cached_request, named_output, resolve_inputs
from torsionnet.linear.frequency_response import quotient_unit
from torsionnet.machinery.excitations.speed_range import SpeedBand
from torsionnet.study.quantities.quantity import StudyQuantity

if TYPE_CHECKING:
    from torsionnet.study.quantities.variant_block import VariantBlock


@dataclass(frozen=True, kw_only=True)
class TransferQuantity(StudyQuantity):
    """Base class of a study's quantities of one transfer function from an input to an output."""

    kind: ClassVar[str] = "transfer function"

    output: str = entry(Text("sensor, node, torque(element), twist(element), stress(shaft), ..."))
    input: str = entry(Text("input or node that is driven, or a sensor: a measured input"))
    excitation: str | None = entry(Text("what drives where the input is measured; default: the only input"), None)

    common: ClassVar[tuple[str, ...]] = ("excitation",)

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        del quantities
        asked = (
            ("output", lambda: named_output(model, self.output)),
            ("input", lambda: resolve_inputs(model, self.input, self.excitation)),
        )
        faults = [fault for name, ask in asked for fault in usage_faults(ask, name)]
        yield from faults or usage_faults(
            lambda: cached_request(model, self.output, self.input, self.excitation), "input"
        )

    @property
    def quotient(self) -> str:
        """Words for the transfer function, such as "theta_1/T_M"."""
        driven_by = f", driven at {self.excitation}" if self.excitation else ""
        return f"{self.output}/{self.input}{driven_by}"

    def unit(self, model: Drivetrain) -> str:
        """SI unit of the transfer function, that of the output over that of the input, empty if it has none."""
        request = cached_request(model, self.output, self.input, self.excitation)
        unit = quotient_unit(request.outputs[0].unit, request.inputs[0].unit)
        return "" if unit == "1" else unit

    def values(self, block: VariantBlock, frequencies: FloatArray) -> ComplexArray:
        """Transfer function (n_variants, n_f) in SI at frequencies (n_f,) or (n_variants, n_f) in Hz."""
        return block.responses(self.output, self.input, frequencies, self.excitation)[:, :, 0, 0]


def usage_faults(ask: Callable[[], object], *path: str) -> Iterator[Fault]:
    """Yield a fault of the UsageError that a call raises, if it raises one."""
    try:
        ask()
    except UsageError as error:
        yield replace(error.fault, path=path)


# Base class of quantities of a study over the speeds of the machinery.

OWN = ("excitations", "speeds", "every")
"""Names of the entries that every quantity over the speeds of the machinery has."""


@dataclass(frozen=True, kw_only=True)
class SpeedQuantity(StudyQuantity):
    """Base class of the quantities of a study at all speeds of the model, or at some of them."""

    kind: ClassVar[str] = "over speed"

    excitations: tuple[str, ...] = entry(Listed("excitations that act; default: all", Text("an excitation")), None)
    speeds: tuple[float, float] | None = entry(SpeedBand("part of the model's speeds"), None)
    every: int = entry(Count("only every n-th of them, and the last, to save time", upper=10_000), 1)

    common: ClassVar[tuple[str, ...]] = OWN

    def at(self, model: Drivetrain) -> FloatArray:
        """Speeds (n_speeds,) in rad/s at which the quantity is calculated; empty where the model has no speeds."""
        given = model.definition.speeds
        speeds = np.array(given.values if given else ())
        if self.speeds is not None:
            low, high = self.speeds
            speeds = speeds[(speeds >= low * (1 - 1e-9)) & (speeds <= high * (1 + 1e-9))]
        return np.append(speeds[:-1][:: self.every], speeds[-1:])

    @staticmethod
    def is_range(model: Drivetrain) -> bool:
        """Whether the model's speeds are a range, which includes all speeds between them, and not a list."""
        given = model.definition.speeds
        return given is not None and not given.list

    @property
    def range_words(self) -> str:
        """Words for the speeds and excitations of the quantity, such as "at all speeds"."""
        acting = f"under {', '.join(self.excitations)}, " if self.excitations else ""
        over = "at all speeds" if self.speeds is None else speed_words(self.speeds)
        return acting + (over if self.every == 1 else f"{over}, one of {self.every}")

    def empty_range_faults(self, model: Drivetrain) -> Iterator[Fault]:
        """Yield a fault where none of the model's speeds lies in the range of the quantity."""
        if model.definition.speeds is not None and not len(self.at(model)):
            yield Fault("none of the model's speeds lies in this range", ("speeds",), kind="out-of-range")


def speed_words(speeds: tuple[float, float]) -> str:
    """Words in r/min for a range of speeds in rad/s.

    >>> speed_words((62.83185307179586, 157.07963267948966))
    'from 600 to 1500 r/min'
    """
    return f"from {speeds[0] * RPM:.6g} to {speeds[1] * RPM:.6g} r/min"
