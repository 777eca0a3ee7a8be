"""Making a report on a model or on a campaign of tests from the options of a call, and writing its files."""

from __future__ import annotations

import datetime as dt
import importlib
import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from torsionnet.base.entries.scalars import parse_band
from torsionnet.base.errors import ModelError, UsageError, comma_list, did_you_mean, fault_of
from torsionnet.base.nearby_files import files_recorded
from torsionnet.base.version import __version__
from torsionnet.drivetrain import Drivetrain, load
from torsionnet.model.channels import Pair, named_sensor
from torsionnet.model.files.reader import find_model
from torsionnet.report.document_tree import Report
from torsionnet.report.measured_orders import MeasuredFile, measured_files
from torsionnet.report.plan.report_plan import KINDS, LANGUAGES, ReportPlan, unknown_section
from torsionnet.report.plan.title_block import TitleBlock
from torsionnet.report.report_data import ReportData, cases_of, digest_of, document_kind, require_answers
from torsionnet.report.report_request import Measured, ReportRequest, read_date

if TYPE_CHECKING:
    from torsionnet.bench.campaign.campaign import Campaign
    from torsionnet.bench.campaign.running_campaign import CampaignResult
    from torsionnet.identification import Fit
    from torsionnet.report.wording import TemplateFolder
    from torsionnet.signals.torque_loops.loop_result import TorqueLoops
    from torsionnet.study.study import Study
    from torsionnet.study.study_result import StudyResult


# Making a report on a model from the options of a call, and writing its files.

# Check that the studies shown in a report are of the model that the report is on.

IGNORED_ENTRIES = ("report", "description", "source")
"""Names of model entries that no result depends on."""
MOST_DIFFERENCES = 6
"""Largest number of differing entries that an error message names."""


def check_study_models(model: Drivetrain, studies: Iterable[Study]) -> None:
    """Refuse studies of other models, or of this model with other values, before anything is calculated.

    Raises
    ------
    UsageError
        With all of them, and what differs.
    """
    refusals = [text for study in studies if (text := _refusal(model, study))]
    if refusals:
        raise UsageError(
            "\n".join([*refusals, "a report shows only studies of its own model; run them again with this model"]),
            kind="unlike-results",
        )


def _refusal(model: Drivetrain, study: Study) -> str:
    own = study.model
    if model.configuration and model.configuration in own.configurations:
        own = own.configured(model.configuration)
    differing = _differing(model.with_entries_named(study.space.names), own)
    if not differing:
        return ""
    if own.name != model.name:
        return f"the study {study.title} is of {own.name}, and the report of {model.name}"
    what = comma_list(differing, MOST_DIFFERENCES)
    return f"the study {study.title} is of another {own.title} than the report of {model.title}: they differ in {what}"


def _differing(model: Drivetrain, other: Drivetrain) -> list[str]:
    """Texts with the names of entries that differ between two models, with their values where these are short."""
    mine, others = _data(model), _data(other)
    differing = []
    for key in dict.fromkeys((*mine, *others)):
        here, there = mine.get(key), others.get(key)
        if isinstance(here, dict) and isinstance(there, dict):
            names = [name for name in dict.fromkeys((*here, *there)) if here.get(name) != there.get(name)]
            differing += [f"{key}.{name}{_values(there.get(name), here.get(name))}" for name in names]
        elif here != there:
            differing.append(key)
    return differing


def _data(model: Drivetrain) -> dict[str, Any]:
    data = json.loads(json.dumps(model.definition.flat_data(), default=str))
    return {key: value for key, value in data.items() if key not in IGNORED_ENTRIES}


def _values(study: Any, report: Any) -> str:
    """Text with the values of a parameter in the study and in the report; empty where it has no single value."""
    shown = [raw.get("value") if isinstance(raw, dict) else raw for raw in (study, report)]
    texts = ["missing" if raw is None else raw for raw in shown]
    return "" if any(isinstance(raw, dict | list) or raw == "" for raw in texts) or texts == ["missing"] * 2 else (
        f" ({texts[0]} in the study, {texts[1]} in the report)"
    )  # fmt: skip


Model: TypeAlias = "str | os.PathLike[str] | Drivetrain"
WRITERS = {".html": "html", ".htm": "html", ".pdf": "pdf", ".docx": "docx", ".tex": "latex", ".md": "markdown"}
"""Name of the module that writes a report, by the ending of the file: a module with a function ``write(report,
path)``."""
REQUIRED = {".pdf": "find_browser", ".docx": "require_docx"}
"""Name of the function of such a module that refuses what is not installed, by the ending."""


def write_report(model: Model, path: str | os.PathLike[str], **options: Any) -> tuple[Path, ...]:
    """Write the report on a model into a file and return the paths of all files written.

    HTML, PDF, Word, LaTeX or Markdown, by the ending of the file.

    Parameters
    ----------
    model : str, path or Drivetrain
        A model file, a library model by name, or a drivetrain.
    path : str or path
        Ends in .html, .pdf, .docx, .tex or .md. LaTeX and Markdown have their figures in the folder ``NAME_figures``
        beside it. PDF needs an installed Chromium, Chrome or Edge, Word the package python-docx.
    **options
        As for :func:`torsionnet.report.make_report`: configurations, sections, transfer_functions, band, settings,
        title, author, notes, angle, simplify, date, tests, fits, studies, measured, loops, template,
        title_block.

    Returns
    -------
    tuple of Path
        Every file written, the report first.

    Raises
    ------
    UsageError
        Another ending, an unknown section, configuration or transfer function.
    MissingExtraError
        A package or, for PDF, a browser is missing.

    Examples
    --------
    >>> import tempfile
    >>> import torsionnet as tn
    >>> path = Path(tempfile.mkdtemp(), "rig.md")
    >>> [file.name for file in tn.write_report("dmf_rig", path, sections=["modes"], date="2025-03-31")]
    ['rig.md', 'mode_shapes.svg']
    """
    write = writer_for(path)
    return write(make_report(model, **options), Path(path))


def writer_for(path: str | os.PathLike[str]) -> Callable[[Report, Path], tuple[Path, ...]]:
    """Function that writes a report into a file with this ending.

    Raises
    ------
    UsageError
        There is none.
    MissingExtraError
        A package or, for PDF, a browser is missing.
    """
    ending = Path(path).suffix.lower()
    if ending not in WRITERS:
        raise UsageError(f'cannot write "{path}": a report ends in {", ".join(WRITERS)}', kind="wrong-file")
    writer = importlib.import_module(f"torsionnet.report.writers.{WRITERS[ending]}")
    if ending in REQUIRED:
        getattr(writer, REQUIRED[ending])()  # before minutes of calculation, not after them
    write: Callable[[Report, Path], tuple[Path, ...]] = writer.write
    return write


def make_report(
    model: Model,
    *,
    kind: str | None = None,
    configurations: Iterable[str] = (),
    sections: Iterable[str] = (),
    transfer_functions: Iterable[str | Pair] = (),
    band: tuple[float, float] | str | None = None,
    settings: Mapping[str, Any] | None = None,
    title: str | None = None,
    author: str | None = None,
    notes: str | None = None,
    angle: str | None = None,
    language: str | None = None,
    simplify: float | str | None = None,
    date: str | dt.date | None = "today",
    tests: Iterable[Any] | Mapping[str, Any] = (),
    fits: Iterable[Fit] = (),
    studies: Iterable[StudyResult] = (),
    measured: Iterable[Any] | Mapping[str, Any] = (),
    loops: Iterable[TorqueLoops] = (),
    template: str | os.PathLike[str] | None = None,
    appendix: bool | None = None,
    title_block: Mapping[str, Any] | TitleBlock | None = None,
    progress: Callable[[str, int, int], None] = lambda *_: None,
) -> Report:
    """Report on a model as a tree of sections, texts, tables and figures.

    Options that are left out are those of the ``report:`` section of its file.

    Parameters
    ----------
    model : str, path or Drivetrain
    kind : {"rig", "approval"}, optional
        Kind of document; default: approval for a model with speeds, excitations and limits.
    configurations : iterable of str
        Default: all.
    sections : iterable of str
        Out of :data:`torsionnet.report.plan.SECTIONS`; default: those of its kind that apply.
    transfer_functions : iterable of str
        ``"theta_1/T_T"``; default: the first sensors over the first input.
    band : (float, float) or str
        Hz, or ``"0.3..40 Hz"``; default: from the modes.
    settings : mapping
        Parameter -> value.
    title, author, notes : str
    angle : {"rad", "deg"}
    language : {"en", "de"}
        Language of the report's own texts.
    simplify : float or str
        0.01 or ``"1 %"``: also transfer functions without the elements that move no mode in the band by more.
    date : str, dt.date or None
        ISO; None: without. Equal models with equal dates give equal files.
    tests : mapping or iterable of FrequencyResponse
        Measured responses, by configuration if there are several.
    fits : iterable of Fit
    studies : iterable of StudyResult
        Of this model, with the answers that their files ask for.
    measured : mapping or iterable of str or path
        Files with orders measured on board, for the measurement plan: paths, ``"CONFIGURATION=FILE"``,
        ``"CONFIGURATION:SENSOR=FILE"``, or paths by configuration.
    loops : iterable of TorqueLoops
        Of a component bench.
    template : str or path
        Folder with a letterhead, style and wording; default: that of the file, a path from there.
    appendix : bool
        Whether the sections of the other kind follow in an appendix.
    title_block : mapping or TitleBlock
        The entries of a mapping replace those of the file one by one, a TitleBlock replaces all.
    progress : function
        Called before each section with its name, the number of sections done and that of all.

    Raises
    ------
    UsageError
        An unknown section, configuration or transfer function, or a study of another model.
    ModelError
        The template folder or the title block is wrong; every fault with its place.

    Examples
    --------
    >>> make_report("dmf_rig", sections=["schematic"], date=None).title
    'Torsional model of the DMF test rig'
    """
    for what, chosen, known in (("kind", kind, tuple(KINDS)), ("language", language, LANGUAGES)):
        if chosen is not None and chosen not in known:
            raise UsageError(
                f'expected {" or ".join(known)} as the {what} of a report, got "{chosen}"{did_you_mean(chosen, known)}',
                kind="unknown-word",
            )
    drivetrain, file, data, inputs = _read_model(model)
    if settings:
        drivetrain = drivetrain.configured(**settings)
    shown = tuple(studies)
    check_study_models(drivetrain, [result.study for result in shown])
    plan = drivetrain.definition.report or ReportPlan()
    read = _template(template or (plan.template and file.parent / plan.template))
    texts: dict[str, Any] = {"title": title, "author": author, "notes": notes, "angle": angle, "simplify": simplify}
    texts |= {"kind": kind, "language": language, "appendix": appendix}
    given: dict[str, Any] = {key: text for key, text in texts.items() if text is not None}
    lists = {
        "configurations": tuple(configurations),
        "sections": _sections(sections),
        "transfer_functions": tuple(
            pair if isinstance(pair, Pair) else Pair.parse(pair) for pair in transfer_functions
        ),
    }
    given |= {key: values for key, values in lists.items() if values}
    # Options given go before those of the report: section.
    given |= {"band": _band(band)} if band else {}
    given |= {} if title_block is None else {"title_block": _title_block(title_block, plan.title_block)}
    plan = replace(plan, **given)
    plan = replace(plan, kind=plan.kind or document_kind(drivetrain))
    today = dt.datetime.now().astimezone().date() if date == "today" else read_date(date)
    request = ReportRequest(
        plan,
        tuple((key, str(value)) for key, value in (settings or {}).items()),
        today,
        _tests(tests),
        tuple(fits),
        shown,
        measured_files(measured, drivetrain),
        tuple(loops),
    )
    _require_plan(request, drivetrain)
    cases = cases_of(drivetrain, plan.configurations, plan.kind, plan.normal)
    inputs += _measured_inputs(request)
    subject = ReportData(drivetrain, cases, request, file.name, digest_of(data), inputs)
    require_answers(subject)
    from torsionnet.machinery.limits.shaft_limit import SOCIETIES
    from torsionnet.report.build import build
    from torsionnet.report.report_text import names_in_reports
    from torsionnet.report.template_reading import Rewording, in_language, in_society_words

    report = build(subject, __version__, progress)
    read = in_language(plan.language, read)
    if read is not None:
        # Names of the model are never translated.
        wording = replace(read.wording, names=names_in_reports(drivetrain))
        reworded: Report = Rewording(wording).reworded(report)
        report = replace(reworded, template=read)
    society = SOCIETIES.get(plan.rules or "")
    return replace(report, sections=in_society_words(report.sections, society)) if society else report


def _require_plan(request: ReportRequest, model: Drivetrain) -> None:
    """Refuse measured orders that the report has no section for."""
    if not request.measured:
        return
    names = ", ".join(file.path.name for file in request.measured)
    if model.definition.speeds is None or not model.definition.excitations:
        raise UsageError(
            f"measured orders ({names}) need the entries speeds: and excitations: of the model", kind="missing-entry"
        )
    if not request.wants("measurement_plan"):
        text = "the report has no section measurement_plan"
        raise UsageError(
            f"measured orders ({names}): {text}; add --section measurement_plan, or leave them out", kind="switched-off"
        )


def _measured_inputs(request: ReportRequest) -> tuple[tuple[str, str], ...]:
    """Names of the files with measured orders, each with its SHA-256; all that cannot be read are told at once."""
    inputs, faults = [], []
    for file in request.measured:
        try:
            inputs.append((file.path.name, digest_of(file.path.read_bytes())))
        except OSError as error:
            faults.append(f"cannot read {file.path}: {error.strerror}")
    if faults:
        raise UsageError("; ".join(faults), kind="unreadable-file")
    return tuple(inputs)


def _read_model(model: Model) -> tuple[Drivetrain, Path, bytes, tuple[tuple[str, str], ...]]:
    """Drivetrain of a model, the file it was read from if any, the bytes that describe it, and the further inputs.

    These are the files that the model names, with their SHA-256; what is described in Python holds their numbers.
    """
    if not isinstance(model, (str, os.PathLike)):
        return model, Path(), model.to_yaml().encode(), ()
    path = find_model(model)
    with files_recorded() as recorded:
        drivetrain = load(model)
    folder = path.parent.resolve()
    inputs = sorted((file.relative_to(folder).as_posix(), digest_of(file.read_bytes())) for file in recorded)
    return drivetrain, path, path.read_bytes(), tuple(inputs)


def _template(folder: str | os.PathLike[str] | None) -> TemplateFolder | None:
    if not folder:
        return None
    from torsionnet.report.template_reading import read_template

    return read_template(folder)


def _title_block(given: Mapping[str, Any] | TitleBlock, of_file: TitleBlock | None) -> TitleBlock:
    entries = {key: getattr(of_file, key) for key in TitleBlock.defaults()} if of_file else {}
    block, faults = TitleBlock.read(given if isinstance(given, TitleBlock) else {**entries, **given})
    if block is None:
        raise ModelError(faults, "the title block")
    return block


def _sections(names: Iterable[str]) -> tuple[str, ...]:
    listed = tuple(names)
    faults = [unknown.message for name in listed if (unknown := unknown_section(name))]
    if faults:
        raise UsageError("\n".join(faults), kind="unknown-word")
    return listed


def _band(raw: tuple[float, float] | str) -> tuple[float, float]:
    try:
        return parse_band(raw)
    except ValueError as error:
        raise UsageError(fault_of(error, "wrong-form")) from None


def _tests(raw: Any) -> tuple[Measured, ...]:
    if isinstance(raw, Mapping):
        return tuple(Measured(response, str(name)) for name, response in raw.items())
    return tuple(entry if isinstance(entry, Measured) else Measured(entry) for entry in raw)


# Report on a campaign of tests: the model, the orders and responses measured beside those calculated, the fit.


def campaign_report(
    result: CampaignResult,
    *,
    sections: Iterable[str] = (),
    progress: Callable[[str, int, int], None] = lambda *_: None,
) -> Report:
    """Report on the model of a campaign in the configurations of its records, with their orders, responses and the fit.

    Parameters
    ----------
    result : CampaignResult
    sections : iterable of str, optional
        As of :func:`make_report`; by default those of the model's kind of document.
    progress : callable, optional
        Called before each section with its name, the number of sections done and that of all.

    Raises
    ------
    UsageError
        No channel of the campaign shows a sensor of the model.
    """
    campaign = result.campaign
    places = _places(campaign) if campaign.of_orders else {}
    if not places and not campaign.of_responses:
        raise UsageError(
            "no channel of the campaign shows a sensor of the model: name one by sensor: for the report",
            kind="unknown-channel",
        )
    model = campaign.model
    own = campaign.plan.report or ReportPlan()
    plan = _plan(campaign, own)
    if places:
        plan = replace(plan, measure=tuple(dict.fromkeys([*places.values(), *own.measure])))
    model = Drivetrain.from_definition(replace(model.definition, report=plan))
    names = {name: _configuration(campaign, entry.configuration) for name, entry in campaign.plan.records.items()}
    measured = [
        MeasuredFile(file, names[name], places[orders.name])
        for name, record in result.records.items()
        for file, orders in zip(record.files, record.orders, strict=False)  # the file of its responses comes last
        if orders.name in places
    ]
    return make_report(
        model,
        configurations=dict.fromkeys(filter(None, names.values())),
        sections=sections,
        measured=measured,
        tests=list(_campaign_tests(result, names)),
        fits=[] if result.fit is None else [result.fit],
        title=own.title or campaign.title,
        template=campaign.folder / own.template if own.template else None,
        progress=progress,
    )


def _plan(campaign: Campaign, own: ReportPlan) -> ReportPlan:
    """Plan of the report: that of the model, but for the entries that the campaign has of its own."""
    defaults = ReportPlan.defaults()
    given = {key: value for key in defaults if (value := getattr(own, key)) != defaults[key]}
    return replace(campaign.model.definition.report or ReportPlan(), **given)


def _campaign_tests(result: CampaignResult, configurations: Mapping[str, str]) -> Iterator[Measured]:
    """Yield the measured response of each record and output, under the names of output and input in the model."""
    campaign, asked = result.campaign, result.campaign.plan.responses
    for name, response in result.responses.items():
        for measured, _ in response.pairs():
            (output,), (into,) = measured.outputs, measured.inputs
            renamed = replace(
                measured,
                outputs=(replace(output, name=campaign.model_outputs[output.name]),),
                inputs=(replace(into, name=(asked.model_input if asked else "") or into.name),),
            )
            yield Measured(renamed, configurations[name], asked.excitation if asked else None)


def _places(campaign: Campaign) -> Mapping[str, str]:
    """Name in the model of the sensor that each channel shows, or the sensor written out, by channel."""
    sensors = campaign.model.definition.sensors
    named = {sensor: name for name, sensor in sensors.items()}
    sensor_of_channel = {name: named_sensor(text, sensors) for name, text in campaign.sensors.items()}
    return {name: named.get(sensor, str(sensor)) for name, sensor in sensor_of_channel.items() if sensor is not None}


def _configuration(campaign: Campaign, name: str) -> str:
    return campaign.model.configured(name).configuration if name else ""
