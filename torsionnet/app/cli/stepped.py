"""Stepped sines at several amplitudes on the command line: of a record alone, and over an element of a model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from torsionnet.app.cli.command import Answer
from torsionnet.app.cli.options import WrongUsage
from torsionnet.app.cli.record_options import RecordReading
from torsionnet.base.notes import NoteOrText
from torsionnet.base.result_rows import Out
from torsionnet.linear.frequency_response import FloatArray

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.signals.stepped_levels import SteppedStiffness


@dataclass(frozen=True, eq=False)
class SteppedRecord:
    """First harmonics at the steps of a sine test, as ``torsionnet estimate --stepped --json`` prints them."""

    title: str
    notes: tuple[NoteOrText, ...]
    frequencies: Annotated[FloatArray, Out(json="frequency_Hz")]
    amplitudes: Annotated[FloatArray, Out(json="amplitude_rad")]
    torque_amplitudes: Annotated[FloatArray, Out(json="torque_amplitude_Nm")]
    mean_twists: Annotated[FloatArray, Out(json="mean_twist_rad")]
    mean_torques: Annotated[FloatArray, Out(json="mean_torque_Nm")]
    real: Annotated[FloatArray, Out(json="k1_Nm_per_rad")]
    imaginary: Annotated[FloatArray, Out(json="k2_Nm_per_rad")]
    loss_factors: Annotated[FloatArray, Out(json="eta_1")]
    other_harmonics: FloatArray


@dataclass(frozen=True, eq=False)
class SteppedComparison(SteppedRecord):
    """Steps of a sine test beside a model, as ``torsionnet compare --stepped --json`` prints them."""

    element: str
    model_real: Annotated[FloatArray, Out(json="model_k1_Nm_per_rad")]
    model_imaginary: Annotated[FloatArray, Out(json="model_k2_Nm_per_rad")]


def _fields(found: SteppedStiffness) -> dict[str, Any]:
    """Fields of a record of steps."""
    return {
        "title": found.title,
        "notes": found.notes,
        "frequencies": found.frequencies,
        "amplitudes": found.amplitudes,
        "torque_amplitudes": np.abs(found.torques),
        "mean_twists": found.mean_twists,
        "mean_torques": found.mean_torques,
        "real": found.stiffness.real,
        "imaginary": found.stiffness.imag,
        "loss_factors": found.loss_factors,
        "other_harmonics": found.distortion,
    }


def stepped_answer(record: str, reading: RecordReading, outputs: tuple[str, ...], inputs: tuple[str, ...]) -> Answer:
    """Answer on the first harmonics at the steps of a record."""
    found = _found(record, reading, outputs, inputs)
    return Answer(
        screen=lambda: [found.table()],
        data=lambda: SteppedRecord(**_fields(found)),
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
        data=lambda: SteppedComparison(
            **_fields(found), element=element, model_real=model.real, model_imaginary=model.imag
        ),
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
