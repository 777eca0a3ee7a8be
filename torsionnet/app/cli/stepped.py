"""Stepped sines at several amplitudes on the command line: of a record alone, and over an element of a model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from torsionnet.app.cli.command import Answer
from torsionnet.app.cli.options import WrongUsage
from torsionnet.app.cli.record_options import RecordReading
from torsionnet.base.result_rows import Out
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.signals.stepped_levels import SteppedStiffness

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


@dataclass(frozen=True, eq=False)
class SteppedComparison:
    """Steps of a sine test beside an element of a model, as ``torsionnet compare --stepped --json`` prints them."""

    SHOWN: ClassVar = (
        *(f"steps.{name}" for name in SteppedStiffness.SHOWN),
        "element",
        "model_real",
        "model_imaginary",
    )

    steps: SteppedStiffness
    element: str
    model: ComplexArray

    @property
    def model_real(self) -> Annotated[FloatArray, Out(json="model_k1_Nm_per_rad")]:
        """Stiffness k' of the model's element at each step in N m/rad, shape (n,)."""
        return self.model.real

    @property
    def model_imaginary(self) -> Annotated[FloatArray, Out(json="model_k2_Nm_per_rad")]:
        """Part k'' of the model's element at each step in N m/rad, shape (n,)."""
        return self.model.imag


def stepped_answer(record: str, reading: RecordReading, outputs: tuple[str, ...], inputs: tuple[str, ...]) -> Answer:
    """Answer on the first harmonics at the steps of a record."""
    found = _found(record, reading, outputs, inputs)
    return Answer(
        screen=lambda: [found.table()],
        data=lambda: found,
        csv=lambda: [("", found.table())],
        figures=lambda _: [("", _figure(found, None))],
    )


def stepped_comparison(
    record: str, reading: RecordReading, channels: tuple[str, str], drivetrain: Drivetrain, sensors: tuple[str, str]
) -> Answer:
    """Answer on a record over the element that two sensors of a model measure."""
    found = _found(record, reading, channels[:1], channels[1:])
    element = _element(drivetrain, sensors)
    table, model = found.compared(drivetrain, element), found.model_stiffness(drivetrain, element)
    return Answer(
        screen=lambda: [table],
        data=lambda: SteppedComparison(found, element, model),
        csv=lambda: [("", table)],
        figures=lambda _: [("", _figure(found, model))],
    )


def _found(record: str, reading: RecordReading, outputs: tuple[str, ...], inputs: tuple[str, ...]) -> SteppedStiffness:
    from torsionnet.app.cli.record_options import load_record
    from torsionnet.signals.recording import Recording

    if len(outputs) != 1 or len(inputs) != 1:
        raise WrongUsage("--stepped takes one --output, a torque, and one --input, a twist", kind="wrong-count")
    measured = load_record(record, reading, (*outputs, *inputs), 0.0, lambda _: None)
    if not isinstance(measured, Recording):
        raise WrongUsage(f"{record} is too large for --stepped; cut it with --from and --to", kind="too-large")
    return measured.stepped_stiffness(outputs[0], inputs[0])


def _element(drivetrain: Drivetrain, sensors: tuple[str, str]) -> str:
    """Element of which the first sensor measures the torque and the second the twist."""
    found = [drivetrain.sensors.get(name) for name in sensors]
    torque, twist = (None if one is None else (one.quantity, one.of) for one in found)
    if torque is None or twist is None or torque[0] != "torque" or twist[0] != "twist" or torque[1] != twist[1]:
        raise WrongUsage(
            "--stepped compares the torque of an element, a sensor {torque: ELEMENT}, over its twist, a sensor "
            "{twist: ELEMENT}; name them by --model-output and --model-input",
            kind="unfit-channel",
        )
    return torque[1]


def _figure(found: SteppedStiffness, model: Any) -> Any:
    from torsionnet.plot.loops_plot import stepped_stiffness

    return stepped_stiffness(found, model)
