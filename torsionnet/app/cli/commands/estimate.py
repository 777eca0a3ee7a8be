"""Command ``torsionnet estimate``, which estimates frequency responses and coherence from a record."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import click

from torsionnet.app.cli.command import TABLE, Answer, ModelCommand, separated_by_lines
from torsionnet.app.cli.frf_output import OF_SOLVERS, ResponseCurves, estimated_curves
from torsionnet.app.cli.options import ALIGN, ANGLE, DRIVEN_BY, STEPPED, USABLE_BAND, WrongUsage, file_option, option
from torsionnet.app.cli.record_options import Averaging, EstimateArguments, Estimator, RecordCommand, RecordReading
from torsionnet.app.cli.terminal import print_warnings
from torsionnet.base.notes import NoteOrText, is_warning
from torsionnet.base.result_fields import to_json
from torsionnet.base.result_rows import Out
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.signals.comparison import AgreementNumber, agreement, agreement_numbers, difference
from torsionnet.signals.stepped_levels import SteppedStiffness

if TYPE_CHECKING:
    from torsionnet.base.conventions import Conventions
    from torsionnet.base.table import Table
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.linear.frequency_response import FrequencyResponse
    from torsionnet.modal.matching import Match
    from torsionnet.modal.modal_estimate import ModalEstimate


RESPONSE_ENDINGS = (".uff", ".unv", ".mat", ".npz", ".csv")


class EstimateCommand(EstimateArguments):
    """Frequency responses and coherence from a record of signals.

    Several inputs are separated from each other; they must not be proportional.

    \b
    torsionnet estimate test.tdms --input T_T --output theta_1 --preset paper --angle-unit deg --plot frf.png
    torsionnet estimate test.csv --input M1 --output phi --quantity phi=angle --unit phi=deg --csv frf.csv
    torsionnet estimate test.npz --input T_T --output theta_1 --reference T_M_set --plot frf.png
    """

    forms = TABLE
    picture = "magnitude, phase and coherence"

    angle: str = ANGLE
    align: bool = ALIGN
    stepped: bool = STEPPED
    output_file: str | None = file_option("Write the response: UFF58, MAT, NPZ or CSV.", RESPONSE_ENDINGS)

    def answer(self) -> Answer:
        from torsionnet.app.cli.frf_output import OF_SOLVERS, estimated_curves
        from torsionnet.base.conventions import Conventions
        from torsionnet.io import write_frequency_response

        if self.stepped:
            if self.output_file:
                raise WrongUsage("--stepped has a table, with --csv; -o writes responses", kind="needless-entry")
            return stepped_answer(self.record, self.reading, self.outputs, self.inputs)
        response = estimate_record(
            self.record,
            self.reading,
            self.outputs,
            self.inputs,
            self.averaging,
            self.estimator,
            self.band,
            align=self.align,
        )
        conventions = Conventions(angle=self.angle)
        return Answer(
            screen=lambda: [peak_table(response, conventions)],
            data=lambda: to_json(estimated_curves(response, conventions), OF_SOLVERS),
            csv=lambda: [("", response.table(conventions))],
            files=[(self.output_file, lambda file: write_frequency_response(response, file))],
            figures=lambda plot: [("", plot.bode(response, conventions=conventions))],
        )


def estimate_record(
    record: str,
    reading: RecordReading,
    outputs: tuple[str, ...],
    inputs: tuple[str, ...],
    averaging: Averaging,
    estimator: Estimator,
    band: tuple[float, float] | None,
    *,
    align: bool,
) -> FrequencyResponse:
    """Frequency response estimated from a record in a band in Hz; its warnings go to stderr."""
    from torsionnet.app.cli.record_options import load_record
    from torsionnet.app.cli.terminal import progress
    from torsionnet.signals.estimators import estimate

    chosen, references = estimator.estimator, estimator.references
    settings = averaging.settings(estimator=chosen)
    with progress("averaging", None) as advance:
        named = (*outputs, *inputs, *references)
        measured = averaging.suited(load_record(record, reading, named, settings.seconds, advance, tests=True))
        response = estimate(measured, outputs, inputs, chosen, settings, reference=references, band=band, align=align)
    print_warnings(response.notes)
    return response


def peak_table(response: FrequencyResponse, conventions: Conventions) -> Table:
    """Table of an estimated response, with a row for its first line and each peak in the usable frequency range."""
    from torsionnet.app.cli.frf_output import output_input_pairs
    from torsionnet.base.table import Column, Table
    from torsionnet.linear.frequency_response import SIGN_NOTE, usable_limit_text

    columns = (
        Column("response"),
        Column("unit"),
        Column("at"),
        Column("frequency", "Hz", 5),
        Column("magnitude", digits=4),
        Column("phase", "deg", 4),
        Column("coherence", "", 3),
    )
    rows: list[tuple[Any, ...]] = []
    for o, i, label in output_input_pairs(response):
        scale, unit = response.scale(conventions, o, i), response.unit(o, i, conventions)
        for name, index in _places(response, o, i):
            value = response.values[index, o, i]
            row = (response.frequencies[index], abs(value) * scale, response.phase[index, o, i])
            coherence = None if response.coherence is None else float(response.coherence[index, o, i])
            rows.append((label, unit, name, *map(float, row), coherence))
    kept = [str(note) for note in response.notes if not is_warning(note)]
    return Table(response.title, columns, tuple(rows), (*kept, *filter(None, [usable_limit_text(response)]), SIGN_NOTE))


def _places(response: FrequencyResponse, o: int, i: int) -> list[tuple[str, int]]:
    from torsionnet.signals.uncertainty import above_noise_up_to, significant_peaks

    if not len(response.frequencies):
        return []
    peaks = significant_peaks(response.between(0, above_noise_up_to(response, o)).magnitude[:, o, i])
    return [("first line", 0), *((f"peak {number}", index) for number, index in enumerate(peaks, 1))]


# Command ``torsionnet compare``, which compares a record with a model.


@dataclass(frozen=True, eq=False)
class ComparedCurves:
    """Curves of a test and of the model's response, as ``torsionnet compare --json`` prints them.

    Differences are test - model.
    """

    test: ResponseCurves
    model: ResponseCurves
    decibels: Annotated[FloatArray, Out(json="difference_dB")]
    degrees: Annotated[FloatArray, Out(json="difference_deg")]
    summary: tuple[AgreementNumber, ...]
    notes: tuple[NoteOrText, ...]


def compared_curves(test: FrequencyResponse, model: FrequencyResponse, conventions: Conventions) -> ComparedCurves:
    """Curves of a test and of the model's response, in the angle unit chosen."""
    apart = difference(test, model)
    return ComparedCurves(
        estimated_curves(test, conventions),
        estimated_curves(model, conventions),
        apart.decibels[:, 0, 0],
        apart.degrees[:, 0, 0],
        agreement_numbers(test, model, conventions),
        agreement(test, model, conventions).notes,
    )


class CompareCommand(ModelCommand, RecordCommand):
    """A record against a model: both responses, how far they are apart, and where the test can be trusted.

    \b
    torsionnet bench amt_bench -c V -o gear_V.npz
    torsionnet compare gear_V.npz amt_rig -c V --output theta_1 --input T_T --preset paper --band 0 40 --plot V.png
    """

    forms = TABLE
    picture = "test over model, with their differences"

    sensor: str = option("--output", metavar="NAME", help="Channel of the record, and sensor of the model.")
    into: str = option("--input", metavar="NAME", help="Channel of the record, and input or sensor.")
    model_output: str | None = option(
        "--model-output", metavar="NAME", help="Sensor of the model, if it has another name there."
    )
    model_input: str | None = option(
        "--model-input", metavar="NAME", help="Input or sensor of the model, if it has another name there."
    )
    driven_by: str | None = DRIVEN_BY
    averaging: Averaging
    estimator: Estimator
    band: tuple[float, float] | None = USABLE_BAND
    angle: str = ANGLE
    align: bool = ALIGN
    stepped: bool = STEPPED

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions

        self.require_one("a record is of one configuration: name one with -c")
        case = self.cases()[0]
        names = (self.model_output or self.sensor, self.model_input or self.into)
        if self.stepped:
            channels = (self.sensor, self.into)
            return stepped_comparison(self.record, self.reading, channels, case.drivetrain, names)
        test = estimate_record(
            self.record,
            self.reading,
            (self.sensor,),
            (self.into,),
            self.averaging,
            self.estimator,
            self.band,
            align=self.align,
        )
        calculated = _calculated(case.drivetrain, test, *names, self.driven_by)
        conventions = Conventions(angle=self.angle)
        return Answer(
            screen=lambda: [agreement(test, calculated, conventions)],
            data=lambda: to_json(compared_curves(test, calculated, conventions), OF_SOLVERS),
            csv=lambda: [("", _full(test, calculated, conventions))],
            figures=lambda plot: [("", plot.comparison(test, calculated, conventions=conventions))],
        )


def _calculated(
    drivetrain: Drivetrain, test: FrequencyResponse, output: str, into: str, excitation: str | None
) -> FrequencyResponse:
    """Calculated response of the model at the frequencies of the test, under the test's channel names."""
    from dataclasses import replace

    response = drivetrain.frequency_response(output, into, test.frequencies, driven_by=excitation)
    same = [
        tuple(replace(channel, name=other.name) for channel, other in zip(mine, theirs, strict=True))
        for mine, theirs in ((response.outputs, test.outputs), (response.inputs, test.inputs))
    ]
    return replace(response, outputs=same[0], inputs=same[1])


def _full(test: FrequencyResponse, model: FrequencyResponse, conventions: Conventions) -> Table:
    """Table of test, model, their differences and coherence, with a row for each frequency in Hz."""
    from torsionnet.base.table import Column, Table

    differences, unit, scale = difference(test, model), test.unit(conventions=conventions), test.scale(conventions)
    data = {
        ("frequency", "Hz"): test.frequencies,
        ("|test|", unit): test.magnitude[:, 0, 0] * scale,
        ("phase test", "deg"): test.phase[:, 0, 0],
        ("|model|", unit): model.magnitude[:, 0, 0] * scale,
        ("phase model", "deg"): model.phase[:, 0, 0],
        ("difference", "dB"): differences.decibels[:, 0, 0],
        ("difference of phase", "deg"): differences.degrees[:, 0, 0],
    }
    if test.coherence is not None:
        data[("coherence", "1")] = test.coherence[:, 0, 0]
    rows = tuple(tuple(map(float, row)) for row in zip(*data.values(), strict=True))
    notes = tuple(map(str, (*test.notes, *model.notes)))
    return Table(model.title, tuple(Column(*key) for key in data), rows, notes)


# Command ``torsionnet identify-modes``, which finds modes in a record without a model.

METHODS = ("auto", "rational", "lscf", "peaks")


class IdentifyModesCommand(EstimateArguments):
    """Natural frequencies, damping ratios and shapes at the sensors from a record, without a model.

    Against a measured torque these are the poles of the drivetrain cut at the transducer; --model compares them with
    those of a model in the same way.

    \b
    torsionnet identify-modes test.npz --output theta_1 --input T_T --preset paper --model amt_rig -c V
    """

    forms = TABLE
    picture = "the stabilisation diagram"

    method: str = option(
        "--method",
        type=click.Choice(METHODS),
        default="auto",
        show_default=True,
        help="rational: few modes of any damping, also close ones; lscf: many light modes; auto: the better of these.",
    )
    model_order: int | None = option("--model-order", type=click.IntRange(1), help="Highest order of the fit.")
    model: str | None = option("--model", metavar="MODEL", help="Compare with the modes of this model.")
    configuration: str = option("--configuration", "-c", metavar="NAME", default="", help="Of that model.")

    def answer(self) -> Answer:

        if self.output.plot_file and self.method == "peaks":
            raise WrongUsage(
                "peak picking has no stabilisation diagram; leave --plot out, or choose another --method",
                kind="needless-entry",
            )
        response = estimate_record(
            self.record,
            self.reading,
            self.outputs,
            self.inputs,
            self.averaging,
            self.estimator,
            self.band,
            align=False,
        )
        if self.band is None and response.usable_up_to is not None:
            response = response.between(0, response.usable_up_to)
        estimate, diagram = _identified(response, self.method, self.model_order)
        compared = _compared(estimate, self.model, self.configuration, self.inputs) if self.model else None
        print_warnings(estimate.notes)
        return Answer(
            screen=lambda: separated_by_lines([estimate.table(), *([compared.table()] if compared else [])]),
            data=lambda: replace(estimate, against_model=compared),
            csv=lambda: [("", estimate.table())],
            figures=lambda plot: [("", plot.stabilisation(diagram, estimate))],
        )


def _identified(response: FrequencyResponse, method: Any, order: int | None) -> tuple[ModalEstimate, Any]:
    from torsionnet.modal import Settings, identify_modes, peak_picking, stabilisation

    if method == "peaks":
        return peak_picking(response), None
    chosen = Settings(method, order, weights="uniform" if response.coherence is None else "coherence")
    diagram = stabilisation(response, chosen)
    return identify_modes(diagram), diagram


def _compared(estimate: ModalEstimate, model: str, configuration: str, inputs: tuple[str, ...]) -> Match:
    from torsionnet.drivetrain import load
    from torsionnet.modal import match

    rig = load(model)
    rig = rig.configured(configuration) if configuration else rig
    measured = [name for name in inputs if name in rig.sensors]
    return match(estimate, rig.modes(measured_input=measured) if measured else rig.modes())


# Stepped sines at several amplitudes on the command line: of a record alone, and over an element of a model.


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
    stepped = _steps(record, reading, outputs, inputs)
    return Answer(
        screen=lambda: [stepped.table()],
        data=lambda: stepped,
        csv=lambda: [("", stepped.table())],
        figures=lambda _: [("", _figure(stepped, None))],
    )


def stepped_comparison(
    record: str, reading: RecordReading, channels: tuple[str, str], drivetrain: Drivetrain, sensors: tuple[str, str]
) -> Answer:
    """Answer on a record over the element that two sensors of a model measure."""
    stepped = _steps(record, reading, channels[:1], channels[1:])
    element = _element(drivetrain, sensors)
    table, model = stepped.compared(drivetrain, element), stepped.model_stiffness(drivetrain, element)
    return Answer(
        screen=lambda: [table],
        data=lambda: SteppedComparison(stepped, element, model),
        csv=lambda: [("", table)],
        figures=lambda _: [("", _figure(stepped, model))],
    )


def _steps(record: str, reading: RecordReading, outputs: tuple[str, ...], inputs: tuple[str, ...]) -> SteppedStiffness:
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
    named = [drivetrain.sensors.get(name) for name in sensors]
    torque, twist = (None if sensor is None else (sensor.quantity, sensor.of) for sensor in named)
    if torque is None or twist is None or torque[0] != "torque" or twist[0] != "twist" or torque[1] != twist[1]:
        raise WrongUsage(
            "--stepped compares the torque of an element, a sensor {torque: ELEMENT}, over its twist, a sensor "
            "{twist: ELEMENT}; name them by --model-output and --model-input",
            kind="unfit-channel",
        )
    return torque[1]


def _figure(stepped: SteppedStiffness, model: Any) -> Any:
    from torsionnet.plot.signal_plots import stepped_stiffness

    return stepped_stiffness(stepped, model)
