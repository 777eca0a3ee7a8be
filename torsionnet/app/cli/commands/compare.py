"""Command ``torsionnet compare``, which compares a record with a model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from torsionnet.app.cli.cases import ModelCommand
from torsionnet.app.cli.command import TABLE, Answer
from torsionnet.app.cli.frf_output import OF_SOLVERS, ResponseCurves, estimated_curves
from torsionnet.app.cli.options import ALIGN, ANGLE, DRIVEN_BY, STEPPED, USABLE_BAND, option
from torsionnet.app.cli.record_options import Averaging, Estimator, RecordCommand
from torsionnet.base.notes import NoteOrText
from torsionnet.base.result_rows import Out, to_json
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.signals.comparison import AgreementNumber, agreement, agreement_numbers, difference

if TYPE_CHECKING:
    from torsionnet.base.conventions import Conventions
    from torsionnet.base.table import Table
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.linear.frequency_response import FrequencyResponse


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
        from torsionnet.app.cli.commands.estimate import estimate_record
        from torsionnet.base.conventions import Conventions

        self.require_one("a record is of one configuration: name one with -c")
        case = self.cases()[0]
        names = (self.model_output or self.sensor, self.model_input or self.into)
        if self.stepped:
            from torsionnet.app.cli.stepped import stepped_comparison

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

    found = drivetrain.frequency_response(output, into, test.frequencies, driven_by=excitation)
    same = [
        tuple(replace(channel, name=other.name) for channel, other in zip(mine, theirs, strict=True))
        for mine, theirs in ((found.outputs, test.outputs), (found.inputs, test.inputs))
    ]
    return replace(found, outputs=same[0], inputs=same[1])


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
