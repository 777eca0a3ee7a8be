"""Section of a report on validity, the assumptions that apply to its model."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from torsionnet.base.errors import Fault, FreeTurningWarning, UsageError
from torsionnet.base.phrases import joined, phrase
from torsionnet.machinery.orders.refined_response import is_periodic
from torsionnet.model.elements import (
    Differential,
    Gear,
    HystereticSpring,
    Lock,
    Planetary,
    RigidCoupling,
    Shaft,
    TabulatedSpring,
)
from torsionnet.model.law_network import keeps_own_point
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Heading,
    Listing,
    Math,
    NumberText,
    Paragraph,
    Remark,
    Section,
    inlines,
)
from torsionnet.report.report_data import ReportData, is_damped
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, capital, first_names, pair_latex, sentence, symbol_or_words

if TYPE_CHECKING:
    from collections.abc import Callable

    from torsionnet.model.definition import Definition
    from torsionnet.model.elements import Element


WARNING = "warning"
"""Severity of a fault that lets a model be calculated although something is probably wrong with it."""
GEARED = (Gear, Planetary, Differential)
MOST_NAMES = 6
"""Largest number of element names that a sentence on validity lists."""

LINEAR = (
    "Linear: small torsional vibrations{about}. Backlash, clearances, friction that sticks, slipping clutches and "
    "stops are not in the model; where a gear unloads or a spring reaches another stage it does not hold."
)
SMALL = "Linear: small torsional vibrations{about}."
LAWS = (
    "Laws of motion ({names}) are linear about the operating point, each with its slope there. A vibration that opens "
    "a gap, reaches another stage or makes friction slip is larger than these results hold for; a simulation over time "
    "has the laws in full. Stops and gaps that no element describes are not in the model."
)
IN_FULL = (
    "Orders and limits over speed are those of periodic motions, with these laws in full; natural frequencies, "
    "critical speeds and passages are linear."
)
LUMPED = (
    "Lumped: what is no shaft from its dimensions is a disc or a spring between discs. It holds well below the first "
    "torsional resonance within any one part. Bending, lateral and axial motion are not considered."
)
VISCOUS = (
    "Viscous damping: its torque is proportional to frequency and fades out towards 0 Hz. Parts whose losses do not "
    "depend on frequency lag more at low frequency than the model says, and less at high frequency."
)
UNDAMPED = "Without damping: peaks are unbounded; their heights in a plot say nothing."
HYSTERETIC = "Hysteretic damping ({names}) is meant for steady vibration; it cannot be simulated over time."
TABULATED = "Stiffness from a table ({names}) holds at the amplitude, preload and temperature it was measured at."
SHAFTS = (
    "Shafts from their dimensions ({names}) are uniform and of circular section, in segments with inertia of their "
    "own; modes with a node of vibration in nearly every segment are not to be trusted: use more segments."
)
GEARS = (
    "Gears ({names}) transmit without play and without errors of the teeth, always in contact. What lies behind a "
    "stage counts with the square of its ratio: an error of 1 % in a ratio is one of 2 % there."
)
GEARS_WITH_BACKLASH = (
    "Gears with backlash ({names}) transmit without errors of the teeth. What lies behind a stage counts with the "
    "square of its ratio: an error of 1 % in a ratio is one of 2 % there."
)
CLAMPS = "Clamps ({names}) are rigid. A real support gives way, which lowers natural frequencies."
COUPLINGS = "Rigid couplings ({names}) neither twist nor damp; their own resonances are taken to lie above the band."
FREE = (
    "The drivetrain can turn freely: angles over torques grow without bound towards 0 Hz. Twists, torques and "
    "differences of angles have a static value, speeds only where something drags on the whole of it."
)
CUT = (
    ". What lies upstream of it has no influence on this transfer function, and a test of it says nothing about that "
    "part."
)
IMPOSED = "Imposed angles ({names}): the drive follows its set-point whatever the torque; elsewhere that node rests."


def validity_section(subject: ReportData) -> Section:
    """Section of a report with the assumptions behind the results, as far as they concern this model.

    A document without the section on the checks has their warnings here.
    """
    blocks: list[Block] = [Listing(tuple(map(inlines, _notes(subject))))]
    if not subject.request.wants("checks"):
        blocks += _condition_warnings(subject)
    return Section("validity", ("Validity",), tuple(blocks))


def _condition_warnings(subject: ReportData) -> Iterator[Remark]:
    """Warnings of the checks, each once, with the conditions that it concerns where these are not all."""
    places: dict[str, list[str]] = {}
    for case in subject.judged_cases:
        for fault in case.drivetrain.check():
            if fault.severity == WARNING:
                places.setdefault(fault.text, []).append(case.configuration)
    # A check of names and entries alone tells of the model as written, whatever the condition.
    for fault in subject.model.check():
        if fault.severity == WARNING and not fault.configuration:
            places.setdefault(fault.text, [])
    known = [case.configuration for case in subject.judged_cases]
    for text, names in places.items():
        where = subject.titles.several(names, known) if 0 < len(names) < len(known) else ""
        words = joined("", (text, phrase(" (in {configurations})", configurations=where))) if where else text
        yield Remark(WARNING, sentence(capital(words) + ".", subject.model))


def _notes(subject: ReportData) -> Iterator[Cell]:
    model = subject.model
    loaded = any(model.mean_speeds.values()) or any(model.mean_torques.values())
    about = phrase(" about the operating point") if loaded else ""
    laws = _names_that_fit(subject, _follows_point)
    if laws:
        yield phrase(SMALL, about=about)
        yield phrase(LAWS, names=laws)
        if subject.has_excitations and any(is_periodic(case.drivetrain, None) for case in subject.cases):
            yield IN_FULL
    else:
        yield phrase(LINEAR, about=about)
    yield LUMPED
    yield from _about(subject, SHAFTS, Shaft)
    if any((case.drivetrain.assembly.system.damping > 0).any() for case in subject.cases):
        yield VISCOUS
    if not any(map(is_damped, subject.cases)):
        yield UNDAMPED
    yield from _about(subject, HYSTERETIC, HystereticSpring)
    yield from _about(subject, TABULATED, TabulatedSpring)
    yield from (f"{capital(note)}." for note in subject.table_reads.notes())
    for text, lash in ((GEARS, False), (GEARS_WITH_BACKLASH, True)):
        gears = _names_that_fit(subject, partial(_is_gear, lash))
        if gears:
            yield phrase(text, names=gears)
    yield from _about(subject, CLAMPS, Lock)
    yield from _about(subject, COUPLINGS, RigidCoupling)
    if subject.request.is_of_kind("responses"):
        yield from _readings(subject)


def _is_gear(with_backlash: bool, element: Element, definition: Definition) -> bool:
    """Whether an element is a gear with a backlash, or one without."""
    del definition
    return isinstance(element, GEARED) and element.has_motion_laws is with_backlash


def _about(subject: ReportData, text: str, *kinds: type[Element]) -> Iterator[str]:
    """Text on an assumption with the names of the elements of these types, if any is in a configuration."""
    names = _names_that_fit(subject, lambda element, _: isinstance(element, kinds))
    if names:
        yield phrase(text, names=names)


def _names_that_fit(subject: ReportData, fits: Callable[[Element, Definition], bool]) -> str:
    """Names of the elements that fit, in any configuration, as a text; empty if there are none."""
    names = {
        name: None
        for case in subject.cases
        for name, element in case.drivetrain.elements.items()
        if fits(element, case.drivetrain.definition)
    }
    return first_names([as_words(name) for name in names], MOST_NAMES)


def _follows_point(element: Element, definition: Definition) -> bool:
    """Whether an element has laws of motion that are linear about the operating point of the model."""
    return element.has_motion_laws and not keeps_own_point(element, definition)


def _readings(subject: ReportData) -> Iterator[Cell]:
    if any("rigid body" in modes.kinds for modes in subject.modes):
        yield FREE
    for pair in subject.pairs:
        if pair.input in subject.model.sensors:
            where = " are those of the drivetrain cut at "
            yield ("Poles of ", Math(pair_latex(pair)), where, *inlines(symbol_or_words(pair.input)), CUT)
    imposed = [name for name, channel in subject.model.inputs.items() if channel.quantity == "angle"]
    if imposed:
        yield phrase(IMPOSED, names=first_names(imposed, MOST_NAMES))


# Section of a report with findings of the checks, and results calculated a second way.

COMPARED_FREQUENCIES = 40
"""Number of frequencies at which two ways of calculation are compared, as more take longer and show the same."""


PASSED = (
    "The model passed all checks without an error, a warning or a note: names, units and dimensions, connections, gear "
    "loops, positive values, in every configuration."
)
"""Sentence of the section on the checks where no check found anything."""


def findings(subject: ReportData) -> list[Fault]:
    """Faults that the checks find in the model as written, then in each configuration."""
    faults = list(subject.model.check())
    for case in subject.judged_cases:
        known = {fault.message for fault in faults}
        faults += [
            replace(fault, configuration=fault.configuration or case.configuration)
            for fault in case.drivetrain.check()
            if fault.message not in known
        ]
    return faults


def warned(subject: ReportData) -> list[Fault]:
    """Warnings of the calculation of a report, each once; that a free drivetrain drifts off at 0 Hz is no news."""
    told = (
        told_warning
        for told_warning in subject.warning_messages
        if not issubclass(told_warning.category, FreeTurningWarning)
    )
    return [
        Fault(text, severity="warning", kind="no-effect")
        for text in dict.fromkeys(str(told_warning.message) for told_warning in told)
    ]


def checks_section(subject: ReportData) -> Section:
    """Section of a report with the findings of the checks and the comparison of two ways of calculation."""
    faults = [*findings(subject), *warned(subject)]
    blocks: list[Block] = []
    if not faults:
        blocks.append(Paragraph((PASSED,)))
    blocks += [Remark(fault.severity, (*sentence(capital(fault.text), subject.model), ".")) for fault in faults]
    rows = list(_comparisons(subject))
    if rows:
        columns = (Heading("Comparison", wide=True), Heading("Largest relative difference", numeric=True))
        blocks.append(table("Results calculated in two ways", columns, rows))
    return Section("checks", ("Checks",), tuple(blocks))


def _comparisons(subject: ReportData) -> Iterator[tuple[Cell, ...]]:
    """Table rows that compare transfer functions by elimination along the drivetrain with a matrix solution."""
    if subject.is_large:
        return
    frequencies = np.geomspace(*subject.band, COMPARED_FREQUENCIES)
    for pair in subject.pairs:
        worst = 0.0
        for case in subject.for_pair(pair).cases:
            try:
                first, second = (
                    case.drivetrain.frequency_response(
                        pair.output, pair.input, frequencies, driven_by=pair.excitation or None, method=method
                    ).values
                    for method in ("graph", "dense")
                )
            except UsageError:
                return
            # Where the response is exactly 0, the difference stays finite.
            size = np.maximum(np.abs(second), 1e-300)
            worst = max(worst, float(np.max(np.abs(first - second) / size)))
        text = (
            Math(pair_latex(pair)),
            phrase(
                " at {count} frequencies: elimination along the drivetrain, and the matrices",
                count=COMPARED_FREQUENCIES,
            ),
        )
        yield text, NumberText(worst, 1)
