"""Building of a report's tree from its data: title block, then section after section."""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

from torsionnet.base.errors import TorsionnetWarning
from torsionnet.linear.assembly.table_range import told_of_reads
from torsionnet.report.document_tree import Facts, Report, Section, Text, TitleTable
from torsionnet.report.plan.report_plan import SECTIONS
from torsionnet.report.plan.title_block import Revision, TitleBlock
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_text import first_names, sentence

# Title block of a report, from its plan and from what the model and the program know themselves.

REVISION_HEADS = ("Revision", "Date", "Description", "Prepared", "Checked", "Approved")
"""Headings of the table of revisions."""
SIGNATURE_HEADS = ("", "Name", "Date", "Signature")
"""Headings of the table that is signed by hand."""
TITLE_FACTS = ("Model", "Author", "Date", "Calculated with", "Model file", "SHA-256", "Input files")
"""Words of the facts that the title block holds, which the list of facts below it leaves out."""


def title_table(subject: ReportData, version: str) -> TitleTable | None:
    """Title block of a report with all its fields, blank ones too; None for the report on a rig unless it is given.

    ``version`` is that of the program.
    """
    plan = subject.request.plan
    if plan.title_block is None and plan.kind != "approval":
        return None
    block = plan.title_block or TitleBlock()
    hull = ("Hull", block.hull) if block.hull else ("Plant", block.plant) if block.plant else ("Hull or plant", "")
    date = subject.request.date.isoformat() if subject.request.date else ""
    file = subject.file or "described in Python"
    return TitleTable(
        rows=(
            (("Project", block.project), ("Document number", block.document_number)),
            (hull, ("Revision", block.revision)),
            (("Owner", block.owner), ("Date", date)),
            (("Yard", block.yard), ("Class society", block.class_society)),
            (("Rules", block.rules), ("Edition", block.edition)),
            (("Engine", block.engine), ("Rating", block.rating)),
            (("Model", subject.model.name), ("Calculated with", f"torsionnet {version}")),
            (("Model file", _hashed(file, subject.digest)),),
            *((("Input file", _hashed(*input_file)),) for input_file in subject.inputs),
        ),
        revision_heads=REVISION_HEADS,
        revisions=tuple(map(_revision, block.revisions or (Revision(),))),
        signature_heads=SIGNATURE_HEADS,
        signatures=(
            ("Prepared", block.prepared or plan.author),
            ("Checked", block.checked),
            ("Approved", block.approved),
        ),
    )


def _hashed(name: str, digest: str) -> str:
    """Text of a file with its hash, without which a result cannot be traced to its data."""
    return f"{name}, SHA-256 {digest}"


def _revision(revision: Revision) -> tuple[str, ...]:
    return (
        revision.revision,
        revision.date,
        revision.description,
        revision.prepared,
        revision.checked,
        revision.approved,
    )


BUILDERS = {
    "conclusion": "conclusion.conclusion_section",
    "summary": "conclusion.summary_section",
    "conditions": "conditions.conditions_section",
    "installation": "installation.installation_section",
    "schematic": "elements.schematic_section",
    "elements": "elements.elements_section",
    "parameters": "elements.parameters_section",
    "kinematics": "equations_and_kinematics.kinematics_section",
    "equations": "equations_and_kinematics.equations_section",
    "mass_elastic": "installation.mass_elastic_section",
    "modes": "modes_by_configuration.modes_section",
    "natural_frequencies": "natural_frequencies.natural_frequencies_section",
    "formulas": "formulas.formulas_section",
    "simplified": "formulas.simplified_section",
    "responses": "responses.responses_section",
    "excitations": "excitations.excitations_section",
    "harmonics": "excitations.harmonics_section",
    "mean_torques": "installation.mean_torques_section",
    "critical_speeds": "resonances.critical_speeds_section",
    "resonances": "resonances.resonances_section",
    "orders": "forced_response.orders_section",
    "periodic_motions": "periodic_motion.periodic_motions_section",
    "forced_response": "forced_response.forced_response_section",
    "limits": "limits_and_passage.limits_section",
    "components": "components.components_section",
    "passage": "limits_and_passage.passage_section",
    "scenarios": "forced_response.scenarios_section",
    "measurement_plan": "measurement_plan.measurement_plan_section",
    "test": "responses.comparison_section",
    "loops": "bench_loops.loops_section",
    "fit": "responses.fit_section",
    "study": "studies.studies_section",
    "checks": "validity.checks_section",
    "validity": "validity.validity_section",
}
"""Module and function that build each section of a report, by the section's name: a document loads what it needs."""


SUBTITLES = {"rig": "Torsional vibration report", "approval": "Torsional vibration calculation"}
"""Line under the title of a report, by the kind of document."""
DRIVETRAIN_SECTIONS = (
    "schematic",
    "elements",
    "kinematics",
    "equations",
    "modes",
    "formulas",
    "simplified",
    "responses",
    "mass_elastic",
)
"""Names of report sections without excitations, in which configurations with equal drivetrains are one case."""


ORDER_SECTIONS = (
    "conclusion",
    "conditions",
    "installation",
    "excitations",
    "harmonics",
    "critical_speeds",
    "resonances",
    "orders",
    "periodic_motions",
    "forced_response",
    "limits",
    "components",
    "passage",
    "measurement_plan",
)
"""Names of report sections on speeds and orders, which a shaft that is locked in a configuration does not have."""


def build(subject: ReportData, version: str, progress: Callable[[str, int, int], None] = lambda *_: None) -> Report:
    """Report on a model as a tree of sections, texts, tables and figures.

    ``version`` is that of the program. ``progress`` is called before each section with its name, the number of
    sections done and that of all.
    """
    plan = subject.request.plan
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always", TorsionnetWarning)
        subject = replace(subject, warning_messages=warned)
        wanted = [name for name in SECTIONS if subject.request.wants(name)]
        made = {}
        with told_of_reads(subject.table_reads.add):
            for done, name in enumerate(wanted):
                progress(name, done, len(wanted))
                made[name] = _builder(name)(_view(subject, name))
    title_block = title_table(subject, version)
    facts = _facts(subject, version)
    return Report(
        title=plan.title or subject.model.name,
        subtitle=SUBTITLES[plan.kind or "rig"],
        facts=Facts(tuple(fact for fact in facts if title_block is None or fact[0] not in TITLE_FACTS)),
        notes=sentence(plan.notes.strip(), subject.model),
        sections=_with_appendix(subject, {name: section for name, section in made.items() if section is not None}),
        author=plan.author,
        date=subject.request.date.isoformat() if subject.request.date else "",
        title_block=title_block,
    )


def _view(subject: ReportData, name: str) -> ReportData:
    """Data of a report as a section sees them: equal drivetrains are one there, or what is locked is left out."""
    if name in DRIVETRAIN_SECTIONS:
        return subject.by_drivetrain
    return subject.turning if name in ORDER_SECTIONS else subject


def _builder(name: str) -> Callable[[ReportData], Section | None]:
    """Function that builds a section of a report; None of it is a section with nothing to say on a model."""
    module, _, function = BUILDERS[name].partition(".")
    builder: Callable[[ReportData], Section | None] = getattr(
        importlib.import_module(f"torsionnet.report.sections.{module}"), function
    )
    return builder


def _with_appendix(subject: ReportData, made: Mapping[str, Section]) -> tuple[Section, ...]:
    """Sections of a report in their order, those of the other kind of document inside an appendix at the end."""
    if subject.request.plan.sections:
        return tuple(made.values())
    own = tuple(section for name, section in made.items() if subject.request.is_of_kind(name))
    others = tuple(section for name, section in made.items() if not subject.request.is_of_kind(name))
    return (*own, Section("appendix", ("Appendix",), others)) if others else own


def _facts(subject: ReportData, version: str) -> Iterator[tuple[str, Text]]:
    request, model = subject.request, subject.model
    yield "Model", (model.name,)
    if model.description:
        yield "Description", (model.description.strip(),)
    if model.source:
        yield "Source of data", (model.source.strip(),)
    names = [case.title for case in subject.cases if case.title]
    if names and not request.is_of_kind("conditions"):
        yield "Configurations", (first_names(names, len(names)) + _others(subject),)
    if request.settings:
        yield "Changed", ("; ".join(f"{name} = {value}" for name, value in request.settings),)
    if request.plan.author:
        yield "Author", (request.plan.author,)
    if request.date:
        yield "Date", (request.date.isoformat(),)
    yield "Calculated with", (f"torsionnet {version}",)
    yield "Model file" if subject.file else "Model", (subject.file or "described in Python",)
    yield "SHA-256", (subject.digest,)
    if subject.inputs:
        yield "Input files", ("; ".join(_hashed(*input_file) for input_file in subject.inputs),)


def _others(subject: ReportData) -> str:
    """Text on how many of the model's configurations the report shows, and whether limits are examined in more."""
    if not subject.left_out:
        return ""
    shown, judged, count = len(subject.cases), len(subject.judged_cases), len(subject.model.configurations)
    more = subject.limit_conclusion is not None and subject.request.wants("limits") and judged > shown
    return f" (of {count}" + (f"; limits are examined in {'all' if judged == count else judged}" if more else "") + ")"
