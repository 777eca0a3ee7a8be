"""Section of a report on the conditions of operation: which were examined, which not and why."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from torsionnet.base.phrases import joined, phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.engine_entries import EngineEntries
from torsionnet.machinery.excitations.reciprocating_engine import conditions_running_alone
from torsionnet.machinery.limits.society_rules import SOCIETIES
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_verdict import FAIL, OPEN, gravest
from torsionnet.machinery.verdicts.speed_spans import permitted_words
from torsionnet.model.configurations import label
from torsionnet.model.load.external_torques import ENGINE
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Heading,
    Listing,
    NumberText,
    Paragraph,
    Section,
    Strong,
    TableBlock,
    Text,
)
from torsionnet.report.plan.report_checks import holds_speed
from torsionnet.report.plan.report_plan import SECTIONS
from torsionnet.report.report_conditions import alternative_words, load_words, speed_words, unexamined
from torsionnet.report.report_cylinders import lost_torque_words
from torsionnet.report.report_data import MOST_JUDGED_CASES, ReportData, normal_choice
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, capital, criterion_words

# Table of a report with the particulars that a classification society asks for, and where they stand.


TITLES = {
    "conclusion": "Conclusion and operating instructions",
    "conditions": "Conditions of operation",
    "mass_elastic": "Mass-elastic data",
    "resonances": "Critical speeds",
    "components": "Shafts, crankshaft, couplings, gears, dampers",
}
"""Titles of the sections that societies ask for, where they are not the words of the name."""


def society_form(subject: ReportData) -> list[Block]:
    """Table of the particulars that the society in ``rules`` of the report asks for, with the sections that hold them.

    Empty where no society is named.
    """
    society = SOCIETIES.get(subject.request.plan.rules or "")
    if society is None:
        return []
    rows = [
        (paragraph, capital(asked), phrase(_title(name) if subject.request.wants(name) else "not in this document"))
        for paragraph, asked, name in society.asked_for
        if name in SECTIONS
    ]
    columns = (Heading("Paragraph"), Heading("Asked for", wide=True), Heading("Section"))
    notes = [f"{society.name}: {society.edition}."]
    if society.marking:
        notes.append(phrase("Barred speed ranges are marked by {marking}.", marking=phrase(society.marking)))
    notes += [f"{capital(society.remark)}."] if society.remark else []
    notes += _speeds_missing(subject, society.highest_critical_ratio)
    if not rows:
        return [Paragraph((" ".join(notes),))]
    return [table("Particulars by the rules of the society", columns, rows, notes)]


def _title(name: str) -> str:
    return TITLES.get(name, capital(as_words(name)))


def _speeds_missing(subject: ReportData, highest: float | None) -> list[str]:
    """Sentence that speeds up to which critical speeds are asked for were not examined; empty where they were."""
    speeds = subject.model.definition.speeds
    if highest is None or speeds is None or speeds.rated is None:
        return []
    reached = max(speeds.values) / speeds.rated
    if reached >= highest * (1 - 1e-9):
        return []
    return [
        phrase(
            "Speeds are examined up to lambda = {reached:.3g}, critical speeds are asked for up to {highest:g}.",
            reached=reached,
            highest=highest,
        )
    ]


NAMED = "Normal condition at rated load: {name}; sections begin with it."
FIRST = (
    "Normal condition at rated load: {name}, the first alternative of each choice, as the model names none; sections "
    "begin with it."
)
MISSING = "The normal condition at rated load, {name}, is not in this document; sections begin with {first}."
"""Sentences on the condition that counts as the normal one."""
MOST_ROWS = 40
"""Largest number of conditions in the table, as many as fit a page."""


def conditions_section(subject: ReportData) -> Section | None:
    """Section of a report on conditions; None for a model without excitations."""
    if not subject.has_excitations:
        return None
    model = subject.model
    said = [speed_words(subject), load_words(model), _normal(subject), _idling(subject)]
    lead = joined(" ", filter(None, said))
    blocks: list[Block] = [Paragraph((lead,))]
    axes = model.definition.configurations
    if len(axes) > 1:
        blocks.append(_alternatives(subject))
    if axes:
        blocks.append(_conditions(subject))
    blocks.append(Paragraph((_examined(subject),)))
    lost = lost_torque_words(subject)
    blocks += [Paragraph((lost,))] if lost else []
    missing = tuple(_not_examined(subject))
    if missing:
        blocks += [Paragraph((Strong("Not examined"),)), Listing(missing)]
    blocks += society_form(subject)
    return Section("conditions", ("Conditions of operation",), tuple(blocks))


def _checks(subject: ReportData) -> Mapping[str, LimitCheck]:
    """Checks of limits by the name of the configuration; empty where no limits are judged."""
    judged = subject.limit_conclusion
    return {} if judged is None else {check.configuration: check for check in judged.checks}


def _normal(subject: ReportData) -> str:
    """Sentence on the condition that counts as the normal one at rated load; empty where there is only one."""
    if len(subject.judged_cases) < 2:
        return ""
    named = subject.request.plan.normal
    wanted = label(normal_choice(subject.model, named), subject.model.definition.configurations)
    title = subject.titles.of(wanted)
    if wanted != subject.normal_case.configuration:
        return phrase(MISSING, name=title, first=subject.normal_case.title)
    return phrase(NAMED if named else FIRST, name=title)


def _idling(subject: ReportData) -> str:
    """Sentence on the speeds of longer idling, and whether a limit bars them in any condition."""
    speeds = subject.request.plan.idling
    if not speeds:
        return ""
    words = []
    for speed in speeds:
        barred = [name for name, check in _checks(subject).items() if not check.permits(speed)]
        names = subject.titles.several(barred, list(_checks(subject))) if barred else ""
        where = phrase(" (not permitted in {names})", names=names) if names else ""
        where = where or (phrase(" (not permitted)") if barred else "")
        words.append(f"{speed * RPM:.6g} rpm{joined('', (_idling_condition(subject, speed), where))}")
    return phrase("Longer idling at {speeds}.", speeds=", ".join(words))


def _idling_condition(subject: ReportData, speed: float) -> str:
    """Words on the conditions that examine a speed of idling in rad/s; empty where all do."""
    known = [case.configuration for case in subject.judged_cases]
    held = [case.configuration for case in subject.judged_cases if holds_speed(case.drivetrain.definition, speed)]
    if len(held) == len(known):
        return ""
    if not held:
        return phrase(", in no condition examined")
    return phrase(" in {names}", names=subject.titles.several(held, known))


def _alternatives(subject: ReportData) -> TableBlock:
    """Table of all alternatives on the axes of the configurations, with what each sets."""
    columns = (Heading("Of"), Heading("Condition"), Heading("What it sets", wide=True))
    rows: list[tuple[Cell, ...]] = [
        (
            capital(as_words(axis)) if not number else "",
            subject.titles.alternative(axis, name),
            alternative_words(subject.model, overlay),
        )
        for axis, alternatives in subject.model.definition.configurations.items()
        for number, (name, overlay) in enumerate(alternatives.items())
    ]
    return table("What the conditions are composed of", columns, rows)


def _conditions(subject: ReportData) -> TableBlock:
    """Table with a row for every examined condition: the verdict on the limits, and what decides it.

    Where there is one axis, with what the condition sets.
    """
    axes, checks = subject.model.definition.configurations, _checks(subject)
    heads = [Heading("Condition"), *([Heading("What it sets", wide=True)] if len(axes) == 1 else [])]
    heads += [Heading("Verdict"), Heading("Speeds permitted"), Heading("Most used limit")]
    heads += [Heading("Speed", "rpm", numeric=True), Heading("Used", "%", numeric=True)]
    rows: list[tuple[Cell, ...]] = []
    for case in subject.judged_cases:
        own: list[Cell] = [capital(case.title)]
        if len(axes) == 1:
            overlay = next(iter(axes.values())).get(case.configuration)
            own.append(alternative_words(subject.model, overlay) if overlay else "")
        check = checks.get(case.configuration)
        rows.append((*own, *([""] * 5 if check is None else _verdict(check))))
    count, every = len(subject.judged_cases), len(subject.model.configurations)
    return table(
        phrase("Conditions examined, {count} of {all}", count=count, all=every),
        heads,
        rows,
        [] if checks else ["The model gives no limits: nothing is judged."],
        most=MOST_ROWS,
        merge=False,
    )


def _verdict(check: LimitCheck) -> tuple[Cell, ...]:
    """Verdict on the limits in a condition with the limits that do not hold, speeds not permitted, most used limit."""
    concerned = [verdict for verdict in check.verdicts if not verdict.elsewhere]
    grave = dict.fromkeys(as_words(verdict.limit) for verdict in concerned if verdict.verdict == check.verdict)
    named = phrase("{verdict}: {limits}", verdict=phrase(check.verdict), limits=", ".join(grave))
    rest = gravest(verdict.verdict for verdict in concerned if verdict.verdict != OPEN)
    if check.verdict == OPEN and any(verdict.verdict != OPEN for verdict in concerned):
        named = phrase("{verdict}; not judged: {limits}", verdict=phrase(rest), limits=", ".join(grave))
    if not grave and check.run_up is not None:
        steady = gravest(verdict.verdict for verdict in concerned)
        starts = map(as_words, check.run_up.names(check.verdict))
        template = "{verdict}; starts {finding}: {limits}"
        named = phrase(template, verdict=phrase(steady), finding=phrase(check.verdict), limits=", ".join(starts))
    (most, *_) = sorted(concerned, key=lambda verdict: -(verdict.worst_utilisation or 0.0))
    return (
        named if check.verdict in (FAIL, OPEN) else check.verdict,
        permitted_words(check.permitted),
        joined(", ", (as_words(most.limit), criterion_words(most.criterion))),
        "" if most.worst_rpm is None else NumberText(most.worst_rpm, 4),
        "" if most.worst_utilisation is None else NumberText(100 * most.worst_utilisation, 3),
    )


def _examined(subject: ReportData) -> str:
    every, judged = subject.model.configurations, [case.configuration for case in subject.judged_cases]
    if not every:
        return "The model has one condition, and it was examined."
    if len(judged) == len(every):
        combined = phrase(", every combination of the choices above") if len(subject.model.axes) > 1 else ""
        return phrase(
            "All conditions of the model ({count}) were examined{combined}.", count=len(every), combined=combined
        )
    return phrase("{count} of {all} conditions of the model were examined.", count=len(judged), all=len(every))


def _not_examined(subject: ReportData) -> Iterator[Text]:
    """Yield what was not examined and why: what the author says, then what the model shows."""
    for what, why in subject.request.plan.not_examined.items():
        yield (Strong(what), f": {why.rstrip('.')}.")
    judged = [case.configuration for case in subject.judged_cases]
    every = subject.model.configurations
    yield from ((note.strip(),) for note in subject.locked_notes)
    missing = [name for name in every if name not in [*judged, *subject.locked]] if len(judged) < len(every) else []
    if missing:
        reason = "this document is on chosen conditions" if len(judged) < MOST_JUDGED_CASES else ""
        reason = reason or phrase("the first {count} are judged unless others are named", count=MOST_JUDGED_CASES)
        yield (f"{capital(subject.titles.several(missing, every))}: {reason}.",)
        unused = list(unexamined(subject.model, subject.titles, judged))
        if unused and len(subject.model.axes) > 1:
            yield (phrase("In no condition examined: {names}.", names=", ".join(unused)),)
    limits_judged = subject.limit_conclusion
    for text in limits_judged.left_out if limits_judged else ():
        yield (f"{capital(text)}.",)
    yield from ((text,) for text in lacking_conditions(subject))


def lacking_conditions(subject: ReportData) -> Iterator[str]:
    """Yield sentences on engines that no condition lets run alone, or with a cylinder out."""
    conditions = [(case.configuration, case.drivetrain.definition.excitations) for case in subject.judged_cases]
    for alone, names in conditions_running_alone(conditions).items():
        if not names:
            yield phrase("Running on {engine} alone: no condition of the model has it.", engine=as_words(alone))
    for name, engine in subject.model.definition.excitations.items():
        states = [now[name] for _, now in conditions]
        fired = engine.kind == ENGINE and not engine.absorbs
        if fired and not any(isinstance(state, EngineEntries) and state.has_lost_cylinder for state in states):
            yield phrase("Misfire of {engine}: no condition of the model has it.", engine=as_words(name))
