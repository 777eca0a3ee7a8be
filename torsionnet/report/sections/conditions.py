"""Section of a report on the conditions of operation: which were examined, what they change, which not and why."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from torsionnet.base.entries.spec import not_none
from torsionnet.base.expressions import Expression, Number
from torsionnet.base.number_text import typeset_unit
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.engine_entries import EngineEntries
from torsionnet.machinery.excitations.reciprocating_engine import conditions_running_alone
from torsionnet.machinery.limits.shaft_limit import SOCIETIES
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_verdict import FAIL, OPEN, gravest
from torsionnet.machinery.verdicts.speed_spans import permitted_words
from torsionnet.model.checks.values import parameter_units
from torsionnet.model.condition_titles import ConditionTitles
from torsionnet.model.configurations import label
from torsionnet.model.damping import MEASURES, DampingMeasure
from torsionnet.model.definition import EXCITATIONS, LOAD, section_of
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
from torsionnet.report.report_cylinders import lost_torque_words
from torsionnet.report.report_data import MOST_JUDGED_CASES, ReportData, normal_choice
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, capital, criterion_words, unit

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.model.configurations import Overlay


# Words of a report on conditions of operation: what the alternatives of configurations change of the model.

UNCHANGED = "as the model is written"
"""Words for an alternative that changes nothing."""
FIRING = {"misfire": "without ignition", "gas_off": "without gas torque"}
"""Words for the state of the cylinders that an entry of an engine names, by the entry."""
GAS = "gas"
"""Entry of an engine with its pressure traces."""
LONGEST_LIST = 12
"""Largest number of values in a list that is written out; of a longer one the length is given."""


def alternative_words(model: Drivetrain, overlay: Overlay) -> str:
    """Text of what an alternative of the configurations changes in the model, in words of the model's file.

    Examples
    --------
    >>> import torsionnet as tn
    >>> model = tn.load("marine_medium_speed")
    >>> axes = model.definition.configurations
    >>> print(alternative_words(model, axes["firing"]["misfire"]))
    Engine: each cylinder in turn without ignition
    >>> print(alternative_words(model, axes["coupling"]["stiff"]))
    Coupling: stiffness 0.40 MN·m/rad instead of 0.30 MN·m/rad (+33 %)
    """
    point = overlay.operating_point
    changes = [
        *(_changed_parameter_words(model, name, value) for name, value in overlay.parameters.items()),
        *(phrase("{name} switched on", name=_element(model, name)) for name in overlay.on),
        *(phrase("{name} switched off", name=_element(model, name)) for name in overlay.off),
        *(_changed_entry_words(model, key, value, overlay.by_files.get(key)) for key, value in overlay.entries.items()),
        *([] if point is None else [_named_value_text("operating_point", point.to_data(), None, "")]),
    ]
    return capital(joined("; ", changes)) if changes else capital(UNCHANGED)


def _changed_parameter_words(model: Drivetrain, name: str, value: Expression) -> str:
    """Text with the new value of a parameter beside the written one, and by how much they differ.

    The description of a parameter is that of the written value, so that it names the new one only where no element
    does.
    """
    number, written = float(value.evaluate(model.exact_values)), float(model.parameters[name])
    own = unit(parameter_units(model.definition)[name])
    share = (
        f" ({100 * (number / written - 1):+.0f} %)".replace("-", "−")
        if written and number and number != written
        else ""
    )
    before = _size(model.parameter_definitions[name].value, written, own)
    return phrase(
        "{what} {value} instead of {before}{share}",
        what=_meant(model, name) or model.parameter_definitions[name].description or as_words(name),
        value=_size(value, number, own),
        before=before,
        share=share,
    )


def _size(value: Expression, number: float, own: str) -> str:
    """Text of a value as it is written, or of its size where an expression gives it."""
    return typeset_unit(str(value)) if isinstance(value, Number) else f"{number:.6g} {own}"


def _meant(model: Drivetrain, name: str) -> str:
    """Text of the entry of the only element that has a parameter as its value; empty where there is none."""
    users = [
        (element, entry)
        for element in model.definition.elements.values()
        for entry, _ in element.specs()
        if name in getattr(getattr(element, entry), "names", ())
    ]
    if len(users) != 1:
        return ""
    ((element, entry),) = users
    value = getattr(element, entry)
    is_measured = isinstance(value, DampingMeasure) and name in value.value.names
    what = MEASURES[value.measure].name if is_measured else as_words(entry)
    return joined(": ", (as_words(element.name), phrase(what)))


def _element(model: Drivetrain, name: str) -> str:
    element = model.definition.elements[name]
    return element.description or as_words(name)


def _changed_entry_words(model: Drivetrain, key: str, value: Any, written: Any = None) -> str:
    """Text of a changed entry of an excitation, an element or the load, which its author may have written by a file."""
    owner, _, name = key.rpartition(".")
    section = section_of(model.definition, key)
    if section is not None and section[0] == EXCITATIONS:
        excitation = model.definition.excitations[owner]
        if name in FIRING:
            if excitation.absorbs:
                return joined(": ", (as_words(owner), _unloaded(excitation, value)))
            return joined("", (as_words(owner), ": ", _cylinders(value), " ", phrase(FIRING[name])))
        if name == "enabled":
            return phrase("{name} running" if value else "{name} not running", name=as_words(owner))
        known = excitation.to_data()
        before = known.get(name) if isinstance(known, Mapping) else None
        if isinstance(value, Mapping) and isinstance(before, Mapping):
            # What stays as it is written is no change.
            value = {key: new for key, new in value.items() if str(before.get(key)) != str(new)} or value
    what = phrase("load") if owner == LOAD else as_words(owner)
    points = "{name}: pressure trace of {count} points" if name == GAS else "{name}: {count} values"
    return joined("", (what, ": ", _named_value_text(name, value, written, points)))


def _unloaded(excitation: Any, value: Any) -> str:
    """Text of the cylinders of a compressor that are unloaded: all alike, or some beside others that are not."""
    known = {str(number) for number in getattr(excitation, "numbers", ())}
    if isinstance(value, Sequence) and not isinstance(value, str) and {*map(str, value)} == known:
        return phrase("all cylinders unloaded alike")
    return phrase("{cylinders} unloaded, the others loaded", cylinders=_cylinders(value))


def _cylinders(value: Any) -> str:
    if value == "each":
        return phrase("each cylinder in turn")
    numbers = list(value) if isinstance(value, Sequence) and not isinstance(value, str) else [value]
    template = "cylinders {number}" if len(numbers) > 1 else "cylinder {number}"
    return phrase(template, number=", ".join(map(str, numbers)))


def _named_value_text(name: str, value: Any, written: Any, points: str) -> str:
    """Text of an entry with its name and its value; of a list too long, ``points`` or the file that it came from."""
    if isinstance(value, Mapping) and not _is_long(value.get("pressures")):
        own = written if isinstance(written, Mapping) else {}
        each = (_named_value_text(str(key), inner, own.get(key), points) for key, inner in value.items())
        return joined(" ", (phrase(as_words(name)), joined(", ", each)))
    pressures = value["pressures"] if isinstance(value, Mapping) else value
    if not _is_long(pressures):
        return joined(" ", (phrase(as_words(name)), _listed(value)))
    template = "{name}: pressure trace of {file}, {count} points" if isinstance(written, str) else points
    return phrase(template, name=as_words(name), file=written, count=len(pressures))


def _is_long(value: Any) -> bool:
    """Whether a value is a list too long to be written out."""
    return isinstance(value, Sequence) and not isinstance(value, str) and len(value) > LONGEST_LIST


def _listed(value: Any) -> str:
    if value is None:
        return phrase("left out")
    if isinstance(value, bool):
        return phrase("yes") if value else phrase("no")
    if isinstance(value, Sequence) and not isinstance(value, str):
        return ", ".join(map(_listed, value))
    return typeset_unit(str(value)) if isinstance(value, str) and "*" in value else as_words(str(value))


def speed_words(subject: ReportData) -> str:
    """Sentences with the shaft, the ranges of speeds in rpm that are calculated in the conditions, and rated speed."""
    speeds = subject.model.definition.speeds
    if speeds is None:
        return ""
    rated = phrase("; rated speed {speed:.6g} rpm", speed=speeds.rated * RPM) if speeds.rated else ""
    ranges: dict[tuple[float, float], list[str]] = {}
    for case in subject.judged_cases:
        values = not_none(case.drivetrain.definition.speeds).values
        ranges.setdefault((values[0] * RPM, values[-1] * RPM), []).append(case.configuration)
    known = [case.configuration for case in subject.judged_cases]
    if len(ranges) > 1:
        template = "Speeds in {conditions}: {low:.6g} to {high:.6g} rpm of {node}{rated}."
        return joined(" ", (
            phrase(template, low=low, high=high, node=as_words(speeds.of), rated=rated,
                   conditions=subject.titles.several(names, known))
            for (low, high), names in ranges.items()
        ))  # fmt: skip
    ((low, high),) = ranges
    return phrase(
        "Speeds in every condition: {low:.6g} to {high:.6g} rpm of {node}{rated}.",
        low=low,
        high=high,
        node=as_words(speeds.of),
        rated=rated,
    )


def load_words(model: Drivetrain) -> str:
    """Sentence on who absorbs and who drives with which share of the power; empty where one does each."""
    load = model.definition.load
    if load is None or len(load.by_place) + len(load.driven_by) < 3:
        return ""
    shares = ", ".join(f"{as_words(name)} {100 * share:.4g} %" for name, share in load.driven_by.items())
    absorbers = ", ".join(map(as_words, load.by_place))
    given = phrase(" and given by {shares}.", shares=shares) if shares else "."
    return joined("", (phrase("Power is absorbed at {nodes}", nodes=absorbers), given))


def unexamined(model: Drivetrain, titles: ConditionTitles, examined: Sequence[str]) -> Iterator[str]:
    """Yield titles of alternatives that no examined configuration has."""
    for axis, alternatives in model.axes.items():
        for name in alternatives:
            label = f"{axis}={name}" if len(model.axes) > 1 else name
            if all(label not in condition.split(",") for condition in examined):
                yield titles.alternative(axis, name)


# Section of a report on the conditions of operation: which were examined, which not and why.

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
