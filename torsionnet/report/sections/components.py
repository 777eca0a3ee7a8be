"""Section of a report on components: what each bears, by which rule and why, and where it is used most."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from torsionnet.base.entries.spec import not_none
from torsionnet.base.number_text import aligned_numbers
from torsionnet.base.phrases import joined, phrase
from torsionnet.machinery.checks.section_checks import limit_subject
from torsionnet.machinery.limits.coupling import temperature_words
from torsionnet.machinery.limits.curve import CurveLimit, crankshaft_throws
from torsionnet.machinery.limits.evidence import LimitSubject
from torsionnet.machinery.limits.iacs_m68 import IacsM68
from torsionnet.machinery.limits.m68_factors import BORE
from torsionnet.machinery.limits.shaft_limit import in_all_words
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion, WorstLimit
from torsionnet.machinery.verdicts.limit_verdict import RuleFactor, RuleSymbol, RuleWords
from torsionnet.machinery.verdicts.speed_spans import utilisation_of
from torsionnet.model.channels import Sensor
from torsionnet.report.component_uses import (
    GROUPS,
    ComponentUse,
    component_uses,
    cyclic_irregularities,
    rated_elsewhere,
)
from torsionnet.report.condition_tables import condition_cell, without_empty
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
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import FACTOR_UNITS, as_words, capital, engineering_unit, unit
from torsionnet.symbolic.symbol_names import GREEK

MOST_SHAFTS = 4
"""Largest number of shafts side by side in one table of factors, as a page has no room for more."""
M68_TEXT: Text = (
    "Permissible stresses by IACS UR M68 in N/mm², with the speed ratio ",
    Math(r"\lambda = n/n_{0}"),
    ": ",
    Math(r"\tau_{C} = C_{W} C_{K} C_{D} (3 - 2\lambda^{2})"),
    " in continuous operation below ",
    Math(r"\lambda = 0.9"),
    ", ",
    Math(r"\tau_{C} = 1.38\, C_{W} C_{K} C_{D}"),
    " from there to 1.05; ",
    Math(r"\tau_{T} = 1.7\, \tau_{C}/\sqrt{C_{K}}"),
    " in quick passage up to ",
    Math(r"\lambda = 0.8"),
    ", with ",
    Math(r"C_{W} = (\sigma_{B} + 160)/18"),
    ". The stress compared is half the range of the sum of all orders, nominal in the plain section.",
)
"""Paragraph with the formulas of IACS UR M68."""
NO_M53 = (
    "Crankshafts are compared with what their maker permits. IACS UR M53 is not covered: it needs the dimensions of "
    "webs and fillets, which this calculation does not have."
)
"""Sentence on what is not calculated for crankshafts."""
EVERY_THROW = "The maker's limit is judged in every throw; {most} uses it most."
ONE_THROW = "The maker's limit is judged in {of} alone; {most} would use it most."
"""Sentences below the table of throws on where the limit of the maker is judged."""


def components_section(subject: ReportData) -> Section | None:
    """Section of a report on components, their limits with sources and their worst condition.

    None for a model without limits.
    """
    limits_judged = subject.limit_conclusion
    if limits_judged is None:
        return None
    uses = component_uses(limits_judged, subject.model.definition, subject.conventions, subject.normal_peaks)
    blocks: list[Block] = [*_m68_shafts(subject, limits_judged), _all_components(subject, limits_judged, uses)]
    elsewhere = rated_elsewhere(subject)
    blocks += [elsewhere] if elsewhere else []
    blocks += [Paragraph((text,)) for text in cyclic_irregularities(subject)]
    judged = [use for use in uses if use.group == "crankshaft" and use.value is not None]
    # Of each limit the criterion that is used most: in continuous operation or in passing.
    crankshafts = {use.worst.verdict.limit: use for use in sorted(judged, key=lambda use: use.worst.utilisation or 0.0)}
    for use in crankshafts.values():
        blocks += _throw_table(subject, use)
    blocks += [Paragraph((NO_M53,))] if crankshafts else []
    blocks += [Paragraph(("Rules and sources:",)), Listing(tuple(_sources(limits_judged)))]
    return Section("components", ("Shafts, crankshaft, couplings, gears, dampers",), tuple(blocks))


def _m68_shafts(subject: ReportData, judged: LimitConclusion) -> Iterator[Block]:
    """Formulas of IACS UR M68 and tables of the factors of the shafts that it is for."""
    limits = subject.model.definition.limits
    shafts = [
        limit
        for limit in judged.worst()
        if isinstance(limits[limit.verdict.limit], IacsM68) and limit.verdict.criterion in in_all_words("tau_C")
    ]
    shafts.sort(key=lambda limit: list(limits).index(limit.verdict.limit))
    if shafts:
        yield Paragraph(M68_TEXT)
    for start in range(0, len(shafts), MOST_SHAFTS):
        yield _factors(subject, shafts[start : start + MOST_SHAFTS])


def _factors(subject: ReportData, shafts: Sequence[WorstLimit]) -> TableBlock:
    names = [as_words(shaft.verdict.limit) for shaft in shafts]
    columns = (
        Heading("Quantity"),
        Heading("Symbol"),
        Heading("Unit"),
        *(Heading(name, numeric=True) for name in names),
        Heading("From", wide=True),
    )
    rows: list[tuple[Cell, ...]] = []
    for alike in zip(*(shaft.verdict.text.factors for shaft in shafts), strict=True):
        if alike[0].symbol == BORE and not any(factor.value for factor in alike):
            continue  # all shafts are solid
        scale, shown = FACTOR_UNITS[alike[0].unit]
        numbers = [NumberText(factor.value * scale) for factor in alike]
        quantity, symbol = _typeset(_capital(alike[0].name)), Math(_latex(alike[0].symbol))
        rows.append((quantity, symbol, unit(shown), *numbers, _origin(names, alike)))
    rated = [_ratio(subject, shaft) for shaft in shafts]
    where = "where it is used most in continuous operation"
    rows.append(
        ("Speed ratio where it is worst", Math(r"\lambda"), unit(""), *(NumberText(ratio) for ratio in rated), where)
    )
    allowed = [shaft.verdict.worst_allowed for shaft in shafts]
    sizes = [NumberText(None if stress is None else stress * 1e-6) for stress in allowed]
    rows.append(("Permissible there", Math(r"\tau_{C}"), unit("N/mm^2"), *sizes, "at this speed ratio"))
    return table("Shafts by IACS UR M68: factors and where they come from", columns, rows)


def _ratio(subject: ReportData, shaft: WorstLimit) -> float | None:
    """Speed ratio at which a shaft is used most, dimensionless; None where it was not judged."""
    definition = subject.model.definition
    limit, speeds, at = definition.limits[shaft.verdict.limit], definition.speeds, shaft.verdict.worst
    rated = (limit.rated if isinstance(limit, IacsM68) else None) or (speeds.rated if speeds else None)
    return None if at is None or rated is None else float(shaft.check.speeds[at]) / rated


def _origin(names: Sequence[str], factors: Sequence[RuleFactor]) -> Text:
    """Text on where a factor comes from, by shaft where the shafts differ."""
    origins = [factor.origin for factor in factors]
    if len(set(origins)) == 1:
        return _typeset(origins[0])
    named: list[str | RuleSymbol] = []
    for name, origin in zip(names, origins, strict=True):
        named += [f"; {name}: " if named else f"{name}: ", *origin]
    return _typeset(named)


def _capital(words: RuleWords) -> RuleWords:
    first, *rest = words
    return (capital(first) if isinstance(first, str) else first, *rest)


def _typeset(words: Sequence[str | RuleSymbol]) -> Text:
    """Words about a rule with its symbols as in print, and no two texts beside each other."""
    parts: list[Inline] = []
    for part in words:
        if isinstance(part, RuleSymbol):
            parts.append(Math(_latex(part)))
        elif parts and isinstance(parts[-1], str):
            parts[-1] = joined("", (parts[-1], part))
        else:
            parts.append(part)
    return tuple(parts)


def _latex(symbol: RuleSymbol) -> str:
    """LaTeX of a symbol of a rule: ``tau_C(0.8)``, ``C_K``, ``sqrt(C_K)``."""
    text = rf"\{symbol.letter}" if symbol.letter in GREEK else symbol.letter
    text += (f"_{{{symbol.index}}}" if symbol.index else "") + (f"^{{{symbol.power}}}" if symbol.power else "")
    text += f"({symbol.at})" if symbol.at else ""
    return rf"\sqrt{{{text}}}" if symbol.root else text


def _all_components(subject: ReportData, judged: LimitConclusion, uses: Sequence[ComponentUse]) -> TableBlock:
    """Table of all components by kind, with values at rated speed in the normal condition and in the worst one."""
    sources = {name: number for number, names in enumerate(_numbered(judged).values(), 1) for name in names}
    columns = (
        Heading("Component"),
        Heading("What is compared", wide=True),
        Heading("Unit"),
        Heading("At rated", numeric=True),
        Heading("Allowed at rated", numeric=True),
        Heading("Used at rated", "%", numeric=True),
        Heading("Worst", numeric=True),
        Heading("Allowed", numeric=True),
        Heading("Used", "%", numeric=True),
        Heading("Speed", "rpm", numeric=True),
        Heading("Worst condition"),
        Heading("Source"),
    )
    groups = []
    for group in GROUPS:
        those = [use for use in uses if use.group == group]
        speeds = aligned_numbers([use.worst.rpm for use in those], 3)
        if those:
            rows = [
                _cells(subject, use, speed, f"[{sources[use.worst.verdict.limit]}]")
                for use, speed in zip(those, speeds, strict=True)
            ]
            groups.append(TableGroup(tuple(rows), capital(group)))
    normal = subject.normal_case
    where = f", {normal.title}," if normal.title else ""
    caption = phrase("Components at rated speed in normal operation{where} and in their worst condition", where=where)
    return without_empty(TableBlock((caption,), columns, tuple(groups)))


def _cells(subject: ReportData, use: ComponentUse, speed: NumberText, source: str) -> tuple[Cell, ...]:
    worst, verdict = use.worst, use.worst.verdict
    case = ""
    if verdict.worst is None:
        remark = "; ".join(verdict.remarks)  # why it was not judged
    else:
        case = as_words(verdict.case)
        remark = "" if verdict.steady_temperature is None else temperature_words(verdict.steady_temperature)
    what: RuleWords = (*_capital(use.what), *([f"; {remark}"] if remark else []))
    sizes = ((use.rated_value, use.rated_allowed, use.rated_utilisation), (use.value, use.allowed, worst.utilisation))
    numbers = (
        cell
        for value, allowed, share in sizes
        for cell in (NumberText(value), NumberText(allowed), NumberText(None if share is None else 100 * share, 3))
    )
    shown = unit(use.unit) if use.unit else ""
    condition = condition_cell(subject, worst.check, case)
    return (as_words(verdict.limit), _typeset(what), shown, *numbers, speed, condition, source)


def _throw_table(subject: ReportData, use: ComponentUse) -> Iterator[Block]:
    """Table of the vibratory torque in every throw, in normal operation and where the crankshaft is used most."""
    check, normal, worst = use.worst.check, subject.normal_case, subject.judged_case(use.worst.check)
    limit, view = subject.model.definition.limits[use.worst.verdict.limit], _limit_subject(worst)
    sensor = limit.sensor(view) if isinstance(limit, CurveLimit) else None
    elements = crankshaft_throws(view, sensor.of) if sensor is not None and sensor.quantity == "torque" else []
    if not elements:
        return
    scale, shown = engineering_unit("N*m", subject.conventions)
    sensors = [Sensor("torque", name) for name in elements]
    columns = [Heading("Throw"), Heading("Between")]
    ports = view.elements
    cells: list[list[Cell]] = [
        [as_words(name) for name in elements],
        [" – ".join(as_words(node) for node in ports[name].ports.values()) for name in elements],
    ]
    peaks = not_none(subject.normal_peaks)
    if peaks.rated is not None and set(elements) <= _limit_subject(normal).active.keys():
        rated = normal.drivetrain.order_response(sensors, speeds=peaks.points.speeds[[peaks.rated]])
        columns.append(Heading("At rated speed, normal", unit(shown), numeric=True))
        cells.append([*aligned_numbers([float(size) * scale for size in rated.half_range[0]])])
    sizes = worst.drivetrain.order_response(sensors, speeds=check.speeds).half_range
    used = utilisation_of(sizes.T, use.worst.verdict.allowed).T
    # The speed where each throw uses the limit most; NaN where the limit says nothing of a speed.
    top = np.nan_to_num(used, nan=-1.0).argmax(axis=0)
    columns += [
        Heading("Largest half range", unit(shown), numeric=True),
        Heading("Speed", "rpm", numeric=True),
        Heading("Used most", "%", numeric=True),
        Heading("At", "rpm", numeric=True),
    ]
    cells += [
        [*aligned_numbers([float(size) * scale for size in sizes.max(axis=0)])],
        [*aligned_numbers([float(check.rpm[at]) for at in sizes.argmax(axis=0)], 3)],
        [NumberText(100 * float(used[at, place]), 3) for place, at in enumerate(top)],
        [*aligned_numbers([float(check.rpm[at]) for at in top], 3)],
    ]
    where = phrase(", largest in condition {name}", name=worst.title) if worst.configuration else ""
    most = elements[int(np.argmax(used[top, range(len(elements))]))]
    text = EVERY_THROW if isinstance(limit, CurveLimit) and limit.throws == "all" else ONE_THROW
    notes = [phrase(text, most=as_words(most), of=as_words(limit.of))]
    yield table(phrase("Vibratory torque by throw{where}", where=where), columns, list(zip(*cells, strict=True)), notes)


def _limit_subject(case: Case) -> LimitSubject:
    return limit_subject(case.drivetrain.definition, case.drivetrain.exact_values)


def _numbered(judged: LimitConclusion) -> dict[tuple[str, str], list[str]]:
    """Names of the limits by the source and, but for IACS UR M68, the formula of their rule."""
    numbered: dict[tuple[str, str], list[str]] = {}
    for check in judged.checks:
        for text, names in check.texts().items():
            known = numbered.setdefault((text.source, "" if text.factors else text.formula), [])
            known += [name for name in names if name not in known]
    return numbered


def _sources(judged: LimitConclusion) -> Iterator[Text]:
    for number, ((source, formula), names) in enumerate(_numbered(judged).items(), 1):
        rule = (". ", formula) if formula else ()
        yield (Strong(f"[{number}] {', '.join(map(as_words, names))}"), ": ", source, *rule, ".")
