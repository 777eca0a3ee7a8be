"""Command ``torsionnet estimate``, which estimates frequency responses and coherence from a record."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from torsionnet.app.cli.command import TABLE, Answer
from torsionnet.app.cli.options import ALIGN, ANGLE, STEPPED, WrongUsage, file_option
from torsionnet.app.cli.record_options import Averaging, EstimateArguments, Estimator, RecordReading
from torsionnet.app.cli.terminal import print_warnings
from torsionnet.base.notes import is_warning
from torsionnet.base.result_rows import to_json

if TYPE_CHECKING:
    from torsionnet.base.conventions import Conventions
    from torsionnet.base.table import Table
    from torsionnet.linear.frequency_response import FrequencyResponse

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
            from torsionnet.app.cli.stepped import stepped_answer

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
    found = significant_peaks(response.between(0, above_noise_up_to(response, o)).magnitude[:, o, i])
    return [("first line", 0), *((f"peak {number}", index) for number, index in enumerate(found, 1))]
