"""Base class of a study's quantities of one transfer function, which have an output, input and excitation."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import Fault, UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.transfer_request import cached_request, named_output, resolve_inputs
from torsionnet.linear.frequency_response import quotient_unit
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
        found = [fault for name, ask in asked for fault in usage_faults(ask, name)]
        yield from found or usage_faults(
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
        found = quotient_unit(request.outputs[0].unit, request.measured[0].unit)
        return "" if found == "1" else found

    def values(self, block: VariantBlock, frequencies: FloatArray) -> ComplexArray:
        """Transfer function (n_variants, n_f) in SI at frequencies (n_f,) or (n_variants, n_f) in Hz."""
        return block.responses(self.output, self.input, frequencies, self.excitation)[:, :, 0, 0]


def usage_faults(ask: Callable[[], object], *path: str) -> Iterator[Fault]:
    """Yield a fault with the message of the UsageError that a call raises, if it raises one."""
    try:
        ask()
    except UsageError as error:
        yield Fault(str(error), path)
