"""``torsionnet report``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from torsionnet.cli.models import STANDARD_INPUT, load_model
from torsionnet.cli.options import Finite, model_options, output_file_option
from torsionnet.cli.record_options import PRESETS, Averaging, RecordReading
from torsionnet.cli.terminal import wrote

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.identification import Fit
    from torsionnet.report.request import Measured
    from torsionnet.response import FrequencyResponse

ENDINGS = (".html", ".pdf", ".tex", ".md", ".htm")


@click.command("report")
@model_options
@output_file_option("Ends in .html, .pdf, .tex or .md.  [default: MODEL.html]", ENDINGS)
@click.option("--section", "sections", metavar="NAME", multiple=True, help="Repeatable.  [default: all that apply]")
@click.option(
    "--tf", "pairs", metavar="OUTPUT/INPUT", multiple=True, help='Transfer function, "theta_1/T_T". Repeatable.'
)
@click.option("--band", type=float, nargs=2, metavar="LOW HIGH", help="Frequencies of the plots in Hz.")
@click.option("--angle", type=click.Choice(["rad", "deg"]), help="Unit of angles.  [default: that of the model]")
@click.option("--title", help="Title of the report.")
@click.option("--author", help="Who signs it.")
@click.option("--date", default="today", show_default=True, help='As 2025-03-31; "none" leaves it out.')
@click.option("--template", metavar="FOLDER", help="Letterhead, style and wording.  [default: that of the model]")
@click.option("--fit", "fits", metavar="FIT.yaml", multiple=True, help="Result of torsionnet fit -o. Repeatable.")
@click.option(
    "--record",
    "records",
    metavar="[CONFIGURATION=]FILE",
    multiple=True,
    help="Test over model: record of signals, or a measured response. Repeatable.",
)
@click.option("--output", metavar="NAME", help="Channel of the records, and sensor of the model.")
@click.option("--input", "into", metavar="NAME", help="Channel of the records, and input or sensor.")
@click.option("--preset", type=click.Choice(PRESETS), help="How the records are averaged; paper: Galvagno (2015).")
@click.option(
    "--seconds",
    type=Finite(0, min_open=True),
    help="Length of a segment of the records in s.  [default: 2]",
)
@click.option(
    "--record-band",
    type=float,
    nargs=2,
    metavar="LOW HIGH",
    help="Frequencies in Hz at which test and model are compared.  [default: --band, else all of the test]",
)
def command(
    model: str,
    configurations: tuple[str, ...],
    settings: tuple[tuple[str, str], ...],
    output_file: str | None,
    sections: tuple[str, ...],
    pairs: tuple[str, ...],
    band: tuple[float, float] | None,
    records: tuple[str, ...],
    output: str | None,
    into: str | None,
    preset: str | None,
    seconds: float | None,
    record_band: tuple[float, float] | None,
    **texts: Any,
) -> None:
    """Write a report on a model: schematic, values, equations, modes, transfer functions, checks, validity.

    What is in it says the report: section of the model file; options say it for this time. Sections: summary,
    schematic, elements, parameters, kinematics, equations, modes, formulas, responses, test, fit, checks, validity.

    \b
    torsionnet report amt_rig
    torsionnet report dmf_rig -o dmf.pdf --author "A. Engineer" --band 0.3 150
    torsionnet report amt_rig -c V --record test.npz --output theta_1 --input T_T --seconds 4 --record-band 0.5 40
    cat model.yaml | torsionnet report - -o model.pdf
    """
    from torsionnet.model.configurations import EVERY
    from torsionnet.report.report import make_report, writer_for

    target = Path(output_file or f"{'model' if model == STANDARD_INPUT else Path(model).stem}.html")
    write = writer_for(target)
    rig = load_model(model)
    plan = rig.definition.report
    compared = _band("--record-band", record_band) or _band("--band", band) or (plan.band if plan else None)
    averaging = Averaging(preset=preset, seconds=seconds)
    named = () if EVERY in configurations and EVERY not in rig.configurations else configurations
    fits = [_fit(name) for name in texts.pop("fits")]
    tests = [_measured(name, rig, output, into, averaging, compared) for name in records]
    report = make_report(
        rig if model == STANDARD_INPUT else model,
        configurations=named or (rig.configurations if configurations else ()),
        sections=sections,
        transfer_functions=pairs,
        band=band,
        settings=dict(settings),
        tests=tests,
        fits=fits,
        **texts,
    )
    for path in write(report, target)[:1]:
        wrote(str(path))


def _fit(name: str) -> Fit:
    from torsionnet.identification import load_fit  # loads scipy.optimize

    return load_fit(name)


def _band(option: str, band: tuple[float, float] | None) -> tuple[float, float] | None:
    if band and not 0 <= band[0] < band[1] < float("inf"):
        raise click.UsageError(f"{option} needs 0 <= LOW < HIGH in Hz, got {band[0]:g} {band[1]:g}")
    return band


def _measured(
    name: str,
    rig: Drivetrain,
    output: str | None,
    into: str | None,
    averaging: Averaging,
    band: tuple[float, float] | None,
) -> Measured:
    """A test in the band where it is compared."""
    from torsionnet.core.errors import UsageError
    from torsionnet.report.request import Measured

    configuration, file = split(name, rig)
    whole = _response(file, output, into, averaging)
    if band is None:
        return Measured(whole, configuration)
    part = whole.between(*band)
    if not len(part.frequencies):
        raise UsageError(f"{file} has nothing between {band[0]:g} and {band[1]:g} Hz; {whole!r}")
    return Measured(part, configuration)


def split(name: str, rig: Drivetrain) -> tuple[str, str]:
    """Configuration and file: ``V=test.npz``, or the file alone."""
    from torsionnet.core.errors import ModelError, UsageError

    before, equals, after = name.rpartition("=")
    if not equals or Path(name).exists():
        return "", name
    try:
        return rig.configured(before).configuration, after
    except (UsageError, ModelError) as error:
        raise UsageError(f'--record "{name}": {error}') from None


def _response(file: str, output: str | None, into: str | None, averaging: Averaging) -> FrequencyResponse:
    """A measured response as it is in its file, or estimated from a record."""
    from torsionnet.core.errors import ModelError, UsageError

    try:
        from torsionnet.io import read_frequency_response

        found = read_frequency_response(file)
        return found.select(output, into)
    except (ModelError, UsageError):
        if not (output and into):
            raise
    from torsionnet.cli.estimate import estimated

    return estimated(file, RecordReading(), (str(output),), (str(into),), averaging, 0.0, None)
