"""Building of a report's tree from its data: title block, then section after section."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

from torsionnet.core.errors import TorsionnetWarning
from torsionnet.model.report import SECTIONS
from torsionnet.report.document_tree import Facts, Report, Section, Text
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_text import first_names, sentence
from torsionnet.report.sections.checks import checks_section
from torsionnet.report.sections.comparison import comparison_section
from torsionnet.report.sections.components import components_section
from torsionnet.report.sections.conclusion import conclusion_section
from torsionnet.report.sections.conditions import conditions_section
from torsionnet.report.sections.critical_speeds import critical_speeds_section
from torsionnet.report.sections.elements import elements_section
from torsionnet.report.sections.equations import equations_section
from torsionnet.report.sections.excitations import excitations_section
from torsionnet.report.sections.fits import fit_section
from torsionnet.report.sections.forced_response import forced_response_section
from torsionnet.report.sections.formulas import formulas_section
from torsionnet.report.sections.installation import installation_section
from torsionnet.report.sections.kinematics import kinematics_section
from torsionnet.report.sections.limits import limits_section
from torsionnet.report.sections.mass_elastic import mass_elastic_section
from torsionnet.report.sections.mean_torques import mean_torques_section
from torsionnet.report.sections.measurement_plan import measurement_plan_section
from torsionnet.report.sections.modes import modes_section
from torsionnet.report.sections.natural_frequencies import natural_frequencies_section
from torsionnet.report.sections.orders import orders_section
from torsionnet.report.sections.parameters import parameters_section
from torsionnet.report.sections.passage import passage_section
from torsionnet.report.sections.resonances import resonances_section
from torsionnet.report.sections.responses import responses_section
from torsionnet.report.sections.schematic import schematic_section
from torsionnet.report.sections.simplified import simplified_section
from torsionnet.report.sections.studies import studies_section
from torsionnet.report.sections.summary import summary_section
from torsionnet.report.sections.torque_harmonics import harmonics_section
from torsionnet.report.sections.validity import validity_section
from torsionnet.report.title_table import TITLE_FACTS, title_table

BUILDERS: dict[str, Callable[[ReportData], Section | None]] = {
    "conclusion": conclusion_section,
    "summary": summary_section,
    "conditions": conditions_section,
    "installation": installation_section,
    "schematic": schematic_section,
    "elements": elements_section,
    "parameters": parameters_section,
    "kinematics": kinematics_section,
    "equations": equations_section,
    "mass_elastic": mass_elastic_section,
    "modes": modes_section,
    "natural_frequencies": natural_frequencies_section,
    "formulas": formulas_section,
    "simplified": simplified_section,
    "responses": responses_section,
    "excitations": excitations_section,
    "harmonics": harmonics_section,
    "mean_torques": mean_torques_section,
    "critical_speeds": critical_speeds_section,
    "resonances": resonances_section,
    "orders": orders_section,
    "forced_response": forced_response_section,
    "limits": limits_section,
    "components": components_section,
    "passage": passage_section,
    "measurement_plan": measurement_plan_section,
    "test": comparison_section,
    "fit": fit_section,
    "study": studies_section,
    "checks": checks_section,
    "validity": validity_section,
}
"""Function that builds each section of a report, by the section's name; None is a section with nothing to say on this
model."""


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
        for done, name in enumerate(wanted):
            progress(name, done, len(wanted))
            made[name] = BUILDERS[name](subject.by_drivetrain if name in DRIVETRAIN_SECTIONS else subject)
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
    names = [case.configuration for case in subject.cases if case.configuration]
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


def _others(subject: ReportData) -> str:
    """Text on how many of the model's configurations the report shows, and whether limits are examined in more."""
    if not subject.left_out:
        return ""
    shown, judged, count = len(subject.cases), len(subject.judged_cases), len(subject.model.configurations)
    more = subject.limit_conclusion is not None and subject.request.wants("limits") and judged > shown
    return f" (of {count}" + (f"; limits are examined in {'all' if judged == count else judged}" if more else "") + ")"
