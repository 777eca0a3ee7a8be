"""Section of a report with the verdict on every component, the operating instructions, and what is not covered."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from torsionnet.base.number_text import aligned_numbers
from torsionnet.base.phrases import phrase
from torsionnet.linear.modes.modes import OSCILLATORY
from torsionnet.machinery.verdicts.condition_peaks import little_damped
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion, WorstLimit
from torsionnet.machinery.verdicts.limit_verdict import OPEN, listed_names
from torsionnet.model.channels import Pair
from torsionnet.model.elements import Shaft
from torsionnet.report.component_uses import limited_element
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Heading,
    Inline,
    Listing,
    Math,
    NumberText,
    Paragraph,
    Section,
    Strong,
    TableBlock,
    TableGroup,
    Text,
)
from torsionnet.report.report_data import Case, ReportData, is_damped
from torsionnet.report.report_instructions import instruction_blocks, run_up_blocks
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, capital, in_clauses, limit_scale, pair_latex, symbol_or_words, unit
from torsionnet.report.sections.conditions import lacking_conditions
from torsionnet.report.sections.limits_and_passage import conclusion, judged_words, verdict
from torsionnet.report.sections.resonances import missed_margins
from torsionnet.report.sections.responses import static_value_and_peaks

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.identification import Fit
    from torsionnet.linear.modes.modes import Modes
    from torsionnet.machinery.limits import Limit


NO_LIMITS = (
    "No limits are given, so nothing is judged: what the components bear stands in the entry limits: of the model file."
)
"""Sentence of a calculation without limits in place of a verdict."""

LITTLE_DAMPED = (
    "{name}, {share:.3g} % of the limit{where}: at {speed:.4g} rpm {order} is in resonance with mode {mode}, whose "
    "calculated damping ratio is only {damping:.1g} %. The value depends on this damping; a measurement is advised."
)
"""Sentence on a governing value that stands at a resonance with little damping."""


def conclusion_section(subject: ReportData) -> Section:
    """Section of a report with verdict, worst condition of every limit, operating instructions and what is open."""
    judged = subject.limit_conclusion
    blocks: list[Block] = [Paragraph((NO_LIMITS,))] if judged is None else [*_judged(subject, judged)]
    return Section("conclusion", ("Conclusion and operating instructions",), tuple(blocks))


def _judged(subject: ReportData, judged: LimitConclusion) -> Iterator[Block]:
    missed = missed_margins(subject)
    apart = ("; ", Strong(phrase("separation margins not kept"))) if missed else ()
    yield Paragraph((Strong("Verdict:"), " ", Strong(judged.verdict), "; ", Strong(judged.starts), *apart))
    findings = [capital(as_words(finding)) for finding in (*missed, *judged.findings, *_switched_off(subject, judged))]
    findings += lacking_conditions(subject)
    yield Listing(tuple((text,) for text in [*findings, *_by_small_damping(subject, judged)]))
    yield _components(subject, judged)
    yield from run_up_blocks(subject, judged)
    yield from instruction_blocks(subject, judged, apart=not missed)
    yield Paragraph(("Not covered:",))
    yield Listing(tuple(_not_covered(subject, judged)))


def _switched_off(subject: ReportData, limits_judged: LimitConclusion) -> Iterator[str]:
    """Sentences on limits that single conditions do not judge, as their parts stand still there."""
    missing: dict[str, list[str]] = {}
    for check in limits_judged.checks:
        absent = dict.fromkeys(
            as_words(limit_verdict.limit)
            for limit_verdict in check.verdicts
            if limit_verdict.verdict == OPEN and limit_verdict.absent
        )
        judged = {as_words(limit_verdict.limit) for limit_verdict in check.verdicts if limit_verdict.verdict != OPEN}
        if names := [name for name in absent if name not in judged]:
            missing.setdefault(listed_names(names), []).append(check.configuration)
    for limits, conditions in missing.items():
        if any(check.configuration not in conditions for check in limits_judged.checks):
            where = phrase(" in {names}", names=subject.titles.several(conditions, subject.model.configurations))
            yield phrase("{limit} not judged{where}", limit=limits, where=where)


def _by_small_damping(subject: ReportData, judged: LimitConclusion) -> Iterator[str]:
    """Sentences on governing values that stand at a resonance of a mode with little damping."""
    for worst, record in little_damped(judged.worst(), subject.critical_records):
        yield phrase(
            LITTLE_DAMPED,
            name=capital(as_words(worst.verdict.limit)),
            share=100 * (worst.utilisation or 0.0),
            speed=worst.rpm,
            where=phrase(" in {names}", names=title) if (title := subject.titles.of(worst.check.configuration)) else "",
            order=as_words(record.name),
            mode=record.critical.mode.number,
            damping=100 * record.critical.mode.damping_ratio,
        )


def _components(subject: ReportData, judged: LimitConclusion) -> TableBlock:
    """Table with a row for each criterion of each limit at its worst speed: in the normal condition, then in any.

    Of all conditions the one that uses the criterion most, and the one with its gravest verdict if that is another.
    """
    columns = (
        Heading("Component"),
        Heading("Limit"),
        Heading("Condition"),
        Heading("Verdict"),
        Heading("Judged", "rpm"),
        Heading("Speed", "rpm", numeric=True),
        Heading("Value", numeric=True),
        Heading("Allowed", numeric=True),
        Heading("Unit"),
        Heading("Utilisation", "%", numeric=True),
    )
    worst = [row for limit in judged.worst() for row in _records(judged, limit)]
    if len(judged.checks) < 2:
        return table(
            "Verdict on every component, at its worst speed", columns, _component_rows(subject, worst, named=False)
        )
    normal = next(check for check in judged.checks if check.configuration == subject.normal_case.configuration)
    groups = (
        TableGroup(
            _component_rows(subject, LimitConclusion((normal,)).worst(), named=False),
            capital(subject.normal_case.title),
        ),
        TableGroup(
            _component_rows(subject, worst, named=True), phrase("Worst of {count} conditions", count=len(judged.checks))
        ),
    )
    caption = "Verdict on every component at its worst speed, in the normal condition and in the worst one"
    return TableBlock((caption,), columns, groups)


def _records(judged: LimitConclusion, worst: WorstLimit) -> Iterator[WorstLimit]:
    """Criterion where it is used most, and in another condition whose verdict on it is graver, each with its own."""
    yield worst
    if worst.gravest != worst.verdict.verdict:
        name = (worst.verdict.limit, worst.verdict.criterion)
        graver = [
            WorstLimit(check, limit_verdict, worst.gravest)
            for check in judged.checks
            for limit_verdict in check.verdicts
            if (limit_verdict.limit, limit_verdict.criterion, limit_verdict.verdict) == (*name, worst.gravest)
        ]
        yield max(graver, key=lambda limit_verdict: limit_verdict.utilisation or 0.0)


def _component_rows(subject: ReportData, worst: Sequence[WorstLimit], *, named: bool) -> tuple[tuple[Cell, ...], ...]:
    """Rows of the table of components; ``named`` tells whether they say the condition."""
    sizes = [_sizes(subject, limit) for limit in worst]
    cells: list[list[Cell]] = [
        [_component(limit) for limit in worst],
        [as_words(limit.verdict.criterion) for limit in worst],
        [subject.titles.of(limit.check.configuration) if named else "" for limit in worst],
        [limit.verdict.verdict for limit in worst],
        [judged_words(limit.verdict) for limit in worst],
        list(aligned_numbers([limit.rpm for limit in worst], 4)),
        ["" if value is None else NumberText(value, 4) for value, _, _ in sizes],
        ["" if allowed is None else NumberText(allowed, 4) for _, allowed, _ in sizes],
        [unit(shown) if shown else "" for _, _, shown in sizes],
        ["" if limit.utilisation is None else NumberText(100 * limit.utilisation, 3) for limit in worst],
    ]
    return tuple(zip(*cells, strict=True))


def _component(worst: WorstLimit) -> str:
    name, of = as_words(worst.verdict.limit), as_words(worst.verdict.of)
    return name if of in name else f"{name} ({of})"


def _sizes(subject: ReportData, worst: WorstLimit) -> tuple[float | None, float | None, str]:
    """Value, value allowed and their unit at the worst speed of a limit; None each where it was not judged."""
    limit_verdict, at = worst.verdict, worst.verdict.worst
    if at is None:
        return None, None, ""
    scale, shown = limit_scale(limit_verdict.unit, subject.conventions)
    return float(limit_verdict.values[at]) * scale, float(limit_verdict.allowed[at]) * scale, shown


def _not_covered(subject: ReportData, limits_judged: LimitConclusion) -> Iterator[Text]:
    """Points that the verdict does not cover: conditions, excitations, and what each rule leaves out."""
    if limits_judged.not_examined:
        yield (phrase("Conditions not examined: {names}.", names=subject.titles.listed(limits_judged.not_examined)),)
    for words in limits_judged.left_out:
        yield (f"{capital(as_words(words))}.",)
    definition = subject.model.definition
    judged = {limited_element(limit, definition) for limit in definition.limits.values()}
    open_shafts = [
        name for name, element in definition.elements.items() if isinstance(element, Shaft) and name not in judged
    ]
    if open_shafts:
        yield (
            phrase(
                "Shafts without a limit, which are not judged: {names}.",
                names=listed_names([*map(as_words, open_shafts)]),
            ),
        )
    unnamed = [name for name, limit in definition.limits.items() if _lacks_source(limit.fitted(definition.elements))]
    if unnamed:
        yield (phrase("Limits whose values have no source: {names}.", names=listed_names([*map(as_words, unnamed)])),)
    # What several rules leave out in the same words is said once, with all their limits.
    of_rules: dict[str, dict[str, None]] = {}
    for check in limits_judged.checks:
        for text, names in check.texts().items():
            if text.not_covered:
                of_rules.setdefault(text.not_covered, {}).update(dict.fromkeys(names))
    for uncovered, limits in of_rules.items():
        yield (Strong(", ".join(map(as_words, limits))), phrase(": {what}.", what=in_clauses(uncovered)))


def _lacks_source(limit: Limit) -> bool:
    """Whether nobody is named who states the values of a limit, neither in the model nor in a catalogue."""
    default = limit.defaults().get("source")
    return isinstance(default, str) and getattr(limit, "source", None) == default


# Section of a report with the results at a glance: lowest modes, peaks and verdicts.

MOST_VIBRATIONS, MOST_PAIRS = 3, 4
"""Largest number of vibrations and of transfer functions that the summary of a report shows."""


def summary_section(subject: ReportData) -> Section:
    """Section of a report with verdict, lowest natural frequencies, fitted models and highest peaks."""
    judged = subject.limit_conclusion if subject.request.wants("limits") else None
    blocks: list[Block] = [] if judged is None else [verdict(judged)]
    blocks += _of_model(subject.by_drivetrain)
    blocks += [fitted for fit in subject.request.fits if (fitted := _fitted(subject, fit)) is not None]
    blocks += [_response(subject.by_drivetrain.for_pair(pair), pair) for pair in subject.pairs[:MOST_PAIRS]]
    if judged is not None:
        blocks.append(conclusion(subject, judged))
    if not blocks:
        blocks.append(Paragraph(("No vibration and no transfer function.",)))
    return Section("summary", ("Results at a glance",), tuple(blocks))


def _fitted(subject: ReportData, fit: Fit) -> TableBlock | None:
    """Table of the lowest natural frequencies in Hz with the fitted values of the parameters.

    None where nothing vibrates.
    """
    modes = tuple(_with_values(fit, case).modes() for case in subject.cases)
    if not any(OSCILLATORY in each.kinds for each in modes):
        return None
    plain = dict.fromkeys(name.partition("[")[0] for name in fit.values)
    names = [name for name in plain if name in subject.model.parameter_definitions]
    note: list[Inline] = ["With the fitted "]
    for name in names:
        note += [", "] * (name != names[0]) + [symbol_or_words(name)]
    title = f" ({fit.title})" if len(subject.request.fits) > 1 and fit.title else ""
    caption = phrase("Lowest natural frequencies and damping ratios of the fitted model{title}", title=title)
    return _vibrations(subject, modes, caption, (*note, "; the values are in the section Fitted parameters."))


def _with_values(fit: Fit, case: Case) -> Drivetrain:
    """Drivetrain of a configuration with the fitted values, those of all configurations and its own."""
    rig = fit.configured(case.drivetrain)
    own = {name.removesuffix(f"[{case.configuration}]"): value for name, value in fit.values.items()}
    return rig.configured(**{name: value for name, value in own.items() if name in rig.parameter_definitions})


def _vibrations(subject: ReportData, shown: tuple[Modes, ...], caption: str, note: Text) -> TableBlock:
    vibrations = [
        [index for index, kind in enumerate(modes.kinds) if kind == OSCILLATORY][:MOST_VIBRATIONS] for modes in shown
    ]
    columns = [Heading("Configuration")]
    cells: list[list[Cell]] = [[case.title for case in subject.cases]]
    for place in range(max(map(len, vibrations))):
        picked = [indices[place] if place < len(indices) else None for indices in vibrations]
        pairs = list(zip(shown, picked, strict=True))
        columns += [
            Heading((Math(f"f_{{{place + 1}}}"),), "Hz", numeric=True),
            Heading((Math(rf"\zeta_{{{place + 1}}}"),), "%", numeric=True),
        ]
        cells.append(list(aligned_numbers([None if i is None else float(m.natural_frequencies[i]) for m, i in pairs])))
        cells.append(
            list(aligned_numbers([None if i is None else 100 * float(m.damping_ratios[i]) for m, i in pairs], 3))
        )
    rows = list(zip(*cells, strict=True))
    return table(caption, columns, rows, [note])


def _of_model(subject: ReportData) -> list[TableBlock]:
    if not any(OSCILLATORY in modes.kinds for modes in subject.modes):
        return []
    damped = "Damped vibrations" if any(map(is_damped, subject.cases)) else "Vibrations"
    note = (damped, " of the whole drivetrain; rigid-body motion and overdamped modes are in the section Modes.")
    return [_vibrations(subject, subject.modes, "Lowest natural frequencies and damping ratios", note)]


def _response(subject: ReportData, pair: Pair) -> TableBlock:
    """Table of static value and highest peak of a transfer function in every configuration."""
    responses = subject.responses(pair)
    scale, shown = responses[0].scale(subject.conventions), unit(responses[0].unit(conventions=subject.conventions))
    points = [static_value_and_peaks(subject, pair, response, index) for index, response in enumerate(responses)]
    static = [entries[0][1].magnitude * scale for entries in points]
    highest = [
        # Behind the static value stand the peaks; a response without resonance has none.
        max((peak for _, peak in entries[1:]), key=lambda peak: peak.magnitude, default=None)
        for entries in points
    ]
    columns = (
        Heading("Configuration"),
        Heading("Static value", shown, numeric=True),
        Heading("Highest peak", shown, numeric=True),
        Heading("at", "Hz", numeric=True),
        Heading("Phase there", "deg", numeric=True),
    )
    rows = zip(
        [case.title for case in subject.cases],
        aligned_numbers(static),
        aligned_numbers([None if peak is None else peak.magnitude * scale for peak in highest]),
        aligned_numbers([None if peak is None else peak.frequency for peak in highest]),
        aligned_numbers([None if peak is None else peak.phase for peak in highest], 3),
        strict=True,
    )
    low, high = subject.band
    return table(
        (Math(pair_latex(pair)), phrase(" between {low:g} and {high:g} Hz", low=low, high=high)),
        columns,
        list(rows),
    )
