"""Command ``torsionnet report``, which writes a report on a model."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from torsionnet.app.cli.command import Answer, ModelCommand
from torsionnet.app.cli.options import (
    PRESETS,
    SIMPLIFY,
    STANDARD_INPUT,
    FiniteFloat,
    WrongUsage,
    band_option,
    file_option,
    load_model,
    option,
)
from torsionnet.app.cli.record_options import Averaging, Estimator, RecordReading
from torsionnet.app.cli.terminal import print_file_written
from torsionnet.base.packages import rare_collections

if TYPE_CHECKING:
    from torsionnet.app.cli.terminal import ShowProgress
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.identification import Fit
    from torsionnet.linear.frequency_response import FrequencyResponse
    from torsionnet.report.report_request import Measured
    from torsionnet.signals.torque_loops.loop_result import TorqueLoops
    from torsionnet.study.study_result import StudyResult

    Band = tuple[float, float] | None

ENDINGS = (".html", ".pdf", ".docx", ".tex", ".md", ".htm")


class ReportCommand(ModelCommand):
    """Write a report on a model: of a rig with equations and transfer functions, of a plant that runs for approval.

    What is in it says the report: section of the model file; options say it for this time. Sections: conclusion,
    summary, conditions, installation, schematic, elements, parameters, kinematics, equations, mass_elastic, modes,
    natural_frequencies, formulas, simplified, responses, excitations, harmonics, mean_torques, critical_speeds,
    resonances, orders, periodic_motions, forced_response, limits, components, passage, scenarios, measurement_plan,
    test, loops, fit, study, checks, validity.

    \b
    torsionnet report amt_rig
    torsionnet report dmf_rig -o dmf.pdf --author "A. Engineer" --band 0.3 150
    torsionnet report amt_rig -c V --record test.npz --output theta_1 --input T_T --seconds 4 --record-band 0.5 40
    cat model.yaml | torsionnet report - -o model.pdf
    """

    output_file: str | None = file_option("Ends in .html, .pdf, .docx, .tex or .md.  [default: MODEL.html]", ENDINGS)
    kind: str | None = option(
        "--kind",
        type=click.Choice(["rig", "approval"]),
        help="Kind of document.  [default: approval with speeds, excitations and limits, else rig]",
    )
    sections: tuple[str, ...] = option("--section", metavar="NAME", help="Repeatable.  [default: those of its kind]")
    appendix: bool | None = option(
        "--appendix", is_flag=True, default=None, help="The other kind's sections follow in an appendix."
    )
    pairs: tuple[str, ...] = option(
        "--tf", metavar="OUTPUT/INPUT", help='Transfer function, "theta_1/T_T". Repeatable.'
    )
    band: tuple[float, float] | None = band_option("Frequencies of the plots in Hz.")
    simplify: float | None = SIMPLIFY
    angle: str | None = option(
        "--angle-unit", type=click.Choice(["rad", "deg"]), help="Unit of angles.  [default: that of the model]"
    )
    language: str | None = option(
        "--language", type=click.Choice(["en", "de"]), help="Language of the report's own texts.  [default: en]"
    )
    title: str | None = option("--title", help="Title of the report.")
    author: str | None = option("--author", help="Who signs it.")
    date: str = option("--date", default="today", show_default=True, help='As 2025-03-31; "none" leaves it out.')
    template: str | None = option(
        "--template", metavar="FOLDER", help="Letterhead, style and wording.  [default: that of the model]"
    )
    fits: tuple[str, ...] = option("--fit", metavar="FIT.yaml", help="Result of torsionnet fit -o. Repeatable.")
    studies: tuple[str, ...] = option(
        "--study",
        metavar="STUDY[=FOLDER]",
        help="Study of this model, from its folder (torsionnet study -o) as far as it is calculated. Repeatable.",
    )
    records: tuple[str, ...] = option(
        "--record",
        metavar="[CONFIGURATION=]FILE",
        help="Test over model: record of signals, or a measured response. Repeatable.",
    )
    loops: tuple[str, ...] = option("--loops", metavar="LOOPS.json", help="Result of torsionnet loops -o. Repeatable.")
    measured: tuple[str, ...] = option(
        "--measured",
        metavar="[CONFIGURATION[:SENSOR]=]FILE",
        help="Orders measured on board, beside those of the measurement plan: CSV, as speed [rpm], order, amplitude "
        "[mrad]. Repeatable.",
    )
    reading: RecordReading
    sensor: str | None = option("--output", metavar="NAME", help="Channel of the records, and sensor of the model.")
    into: str | None = option("--input", metavar="NAME", help="Channel of the records, and input or sensor.")
    preset: str | None = option(
        "--preset", type=click.Choice(PRESETS), help="How the records are averaged; paper: Galvagno (2015)."
    )
    seconds: float | None = option(
        "--seconds", type=FiniteFloat(0, min_open=True), help="Length of a segment of the records in s.  [default: 2]"
    )
    record_band: tuple[float, float] | None = option(
        "--record-band",
        type=float,
        nargs=2,
        metavar="LOW HIGH",
        help="Frequencies in Hz at which test and model are compared.  [default: --band, else all of the test]",
    )

    def answer(self) -> Answer:
        from torsionnet.app.cli.terminal import stages

        with stages() as show, rare_collections():
            written = self._write(show)
        print_file_written(str(written))
        return Answer()

    def _write(self, show: ShowProgress) -> Path:
        from torsionnet.model.configurations import ALL_CONFIGURATIONS
        from torsionnet.report.report import make_report, writer_for

        piped = self.model == STANDARD_INPUT
        target = Path(self.output_file or f"{'model' if piped else Path(self.model).stem}.html")
        write = writer_for(target)
        show("reading", 0, None, "reading the model")
        rig = load_model(self.model)
        plan = rig.definition.report
        # A record is compared in a band of its own, else in that of the report.
        compared = (
            _band("--record-band", self.record_band) or _band("--band", self.band) or (plan.band if plan else None)
        )
        averaging = Averaging(preset=self.preset, seconds=self.seconds)
        named = (
            ()
            if ALL_CONFIGURATIONS in self.configurations and ALL_CONFIGURATIONS not in rig.configurations
            else self.configurations
        )
        fits = [_fit(name) for name in self.fits]
        studies = _studies(self.studies, rig.configured(**dict(self.settings)) if self.settings else rig, show)
        how = self.reading, averaging
        tests = [_measured(name, rig, (self.sensor, self.into), how, compared) for name in self.records]
        report = make_report(
            # By its path, so that the document has the digest of the file; what was piped has no file.
            rig if piped else self.model,
            kind=self.kind,
            appendix=self.appendix,
            configurations=named or (rig.configurations if self.configurations else ()),
            sections=self.sections,
            transfer_functions=self.pairs,
            band=self.band,
            settings=dict(self.settings),
            tests=tests,
            fits=fits,
            studies=studies,
            measured=self.measured,
            loops=[_loops(name) for name in self.loops],
            angle=self.angle,
            language=self.language,
            simplify=self.simplify,
            title=self.title,
            author=self.author,
            date=self.date,
            template=self.template,
            progress=lambda name, done, total: show("sections", done, total, f"section {name.replace('_', ' ')}"),
        )
        show("writing", 0, None, f"writing {target.name}")
        return write(report, target)[0]


def _fit(name: str) -> Fit:
    from torsionnet.identification import load_fit  # loads scipy.optimize

    return load_fit(name)


def _loops(name: str) -> TorqueLoops:
    from torsionnet.signals.torque_loops.loop_result import TorqueLoops

    return TorqueLoops.from_json(name)


def _studies(names: tuple[str, ...], rig: Drivetrain, show: ShowProgress) -> list[StudyResult]:
    """Results of the studies named, in their order, calculated as far as their folders do not have them."""
    if not names:
        return []
    from torsionnet.report.report import check_study_models
    from torsionnet.study import load_study, run_study

    pairs = [name.partition("=") for name in names]
    studies = [load_study(file) for file, _, _ in pairs]
    check_study_models(rig, studies)
    return [
        run_study(study, folder or None, progress=_shown(show, f"study {file}"))
        for study, (file, _, folder) in zip(studies, pairs, strict=True)
    ]


def _shown(show: ShowProgress, stage: str) -> Callable[[int, int], None]:
    return lambda done, total: show(stage, done, total)


def _band(option: str, band: tuple[float, float] | None) -> tuple[float, float] | None:
    if band and not 0 <= band[0] < band[1] < float("inf"):
        raise WrongUsage(f"{option} needs 0 <= LOW < HIGH in Hz, got {band[0]:g} {band[1]:g}", kind="unordered-rows")
    return band


def _measured(
    name: str,
    rig: Drivetrain,
    names: tuple[str | None, str | None],
    how: tuple[RecordReading, Averaging],
    band: tuple[float, float] | None,
) -> Measured:
    """Measured response of a test with its configuration, cut to the band in Hz where it is compared."""
    from torsionnet.base.errors import UsageError
    from torsionnet.report.report_request import Measured

    configuration, file = configuration_and_file(name, rig)
    whole = _response(file, *names, *how)
    if band is None:
        return Measured(whole, configuration)
    part = whole.between(*band)
    if not len(part.frequencies):
        text = f"{file} has no frequency between {band[0]:g} and {band[1]:g} Hz; choose a band within what it has"
        raise UsageError(f"{text}: {whole!r}", kind="wrong-form")
    return Measured(part, configuration)


def configuration_and_file(name: str, rig: Drivetrain) -> tuple[str, str]:
    """Name of the configuration and of the file that ``--record`` gives: ``V=test.npz``, or the file alone."""
    from torsionnet.base.errors import ModelError, UsageError

    before, equals, after = name.rpartition("=")
    if not equals or Path(name).exists():
        return "", name
    try:
        return rig.configured(before).configuration, after
    except (UsageError, ModelError) as error:
        raise UsageError(f'--record "{name}": {error}', kind=error.kind) from None


def _response(
    file: str, output: str | None, into: str | None, reading: RecordReading, averaging: Averaging
) -> FrequencyResponse:
    """Measured frequency response read from its file, or estimated from a record."""
    from torsionnet.base.errors import ModelError, UsageError

    try:
        from torsionnet.io import read_frequency_response

        response = read_frequency_response(file)
        return response.select(output, into)
    except (ModelError, UsageError):
        if not (output and into):
            raise
    from torsionnet.app.cli.commands.estimate import estimate_record

    return estimate_record(file, reading, (str(output),), (str(into),), averaging, Estimator(), None, align=False)
