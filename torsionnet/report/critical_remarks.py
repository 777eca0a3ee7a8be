"""Remarks below a report's tables of critical speeds: what columns are, what is left out, and what cancels."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from torsionnet.base.number_text import NumberText, prefix_of
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.machinery.orders.operating_groups import drivetrains_at_speeds
from torsionnet.machinery.verdicts.condition_peaks import ConditionPeaks, JudgedCritical
from torsionnet.machinery.verdicts.order_peaks import LEAST_SHARE, SMALL_SHARE, order_shares
from torsionnet.model.elements import Propeller
from torsionnet.report.document_tree import Text
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_text import DIGITS, as_words, first_names, unit

MOST_NAMED = 40
"""Largest number of further critical speeds that a note names."""
CANCELLING = 0.1
"""Vector sum of an order on a mode, over what the same torques would make in phase, below which they count as
cancelling: uneven cylinders then decide what is left."""
CANCELLING_SOURCES = 0.5
"""Sum of the orders of several sources at one frequency, over the largest of them, below which they count as
cancelling."""
CRITICAL_NOTES = (
    "Critical speed: where the order meets the natural frequency with damping. Peak at: where the order alone is "
    "largest in the component, apart from it by damping. The sum of all orders is largest at speeds of its own.",
    "Order alone: its amplitude, peak value; all orders: half range of their sum at the same speed. Allowed: in "
    "continuous operation; in passing: while the speed is passed, where a rule says it.",
)
"""Notes below the table of critical speeds that say what its columns are."""
PROPELLER_LAWS = (
    ("archer", "by Archer c = a Q/n"),
    ("exponent", "as the slope of Q ω^m, c = m Q/ω"),
    ("torque_slope", "as the slope of the open-water torque"),
)
"""Laws of damping by the water that follow torque and speed, by the entry of a propeller that selects one."""
LEAST_LOSS = 0.05
"""Loss factor from which on a spring counts as a coupling, as of rubber; shafts of steel have less."""
NO_PEAK = "Without a speed of its peak the order has no maximum of its own; values are those at the critical speed."


def notes_on_criticals(subject: ReportData, peaks: ConditionPeaks, shown: Sequence[JudgedCritical]) -> Iterator[Text]:
    """Yield the notes below the table of critical speeds in the normal condition, of which ``shown`` are listed."""
    yield from ((note,) for note in CRITICAL_NOTES)
    if any(not record.is_peak for record in shown):
        yield (NO_PEAK,)
    yield from ((note,) for note in propeller_dampings(subject.normal_case, shown))
    yield from ((note,) for note in coupling_dampings(subject.normal_case, shown))
    yield from ((note,) for note in (*cancelling_sources(shown), *cancelling_cylinders(subject, shown)))
    # What the table leaves out is bounded by one number.
    rest = [record for record in peaks.criticals if record.point is not None and record not in shown]
    if rest:
        yield (
            phrase(
                "At other critical speeds in the range the order alone uses at most {share:.2g} % of a limit: {names}.",
                share=100 * max(record.share for record in rest),
                names=places_words(rest),
            ),
        )
    shares = zip(peaks.check.lines, order_shares(peaks.check).tolist(), strict=True)
    small = [as_words(line) for line, share in shares if share < SMALL_SHARE]
    if small:
        yield (
            phrase(
                "Every other order alone uses less than {share:g} % of a limit at all speeds examined: {names}.",
                share=100 * SMALL_SHARE,
                names=first_names(small, MOST_NAMED),
            ),
        )
    yield from ((note,) for note in beside_range(peaks, shown))
    yield from _distances(subject, shown)


def beside_range(peaks: ConditionPeaks, shown: Sequence[JudgedCritical]) -> Iterator[str]:
    """Yield the sentence on critical speeds of a condition outside of the speeds examined, as strong as those shown."""
    strongest = max((record.critical.resonant_amplitude for record in shown), default=0.0)
    beyond = [
        record
        for record in peaks.criticals
        if record.point is None and record.critical.resonant_amplitude >= LEAST_SHARE * strongest
    ]
    low, high = peaks.check.rpm[0], peaks.check.rpm[-1]
    for passed, names in places_beside(peaks, beyond):
        text = "Beside the range of {low:.6g} to {high:.6g} rpm, not examined: {names}."
        if passed:
            text = "Beside the range of {low:.6g} to {high:.6g} rpm, passed and judged by starts alone: {names}."
        yield phrase(text, low=low, high=high, names=names)


def places_beside(peaks: ConditionPeaks, beyond: Sequence[JudgedCritical]) -> Iterator[tuple[bool, str]]:
    """Yield whether starts pass critical speeds beside the range of a condition, and the words of these."""
    start = peaks.check.run_up
    passes = [start is not None and start.low <= record.critical.natural_speed <= start.high for record in beyond]
    for passed in (True, False):
        records = [record for record, is_passed in zip(beyond, passes, strict=True) if is_passed is passed]
        if records:
            yield passed, places_words(records)


def propeller_dampings(case: Case, records: Sequence[JudgedCritical]) -> Iterator[str]:
    """Yield a sentence for each propeller whose damping follows the speed: its law, and it at the critical speeds."""
    definition = case.drivetrain.definition
    laws = {
        name: law
        for name, element in case.drivetrain.elements.items()
        if isinstance(element, Propeller)
        for entry, law in PROPELLER_LAWS
        if getattr(element, entry) is not None
    }
    speeds = np.unique(
        [record.critical.natural_speed for record in records if math.isfinite(record.critical.natural_speed)]
    )
    if not laws or not definition.follows_speed or definition.speeds is None or not len(speeds):
        return
    dampings: dict[str, list[float]] = {name: [] for name in laws}
    # Such a law has another damping at each critical speed.
    for rig, places in drivetrains_at_speeds(case.drivetrain, definition.speeds.of, speeds):
        for owner, law in zip(rig.assembly.owners, rig.assembly.laws, strict=True):
            if owner in dampings:
                dampings[owner] += [float(law.damping)] * len(places)
    for name, sizes in dampings.items():
        prefix, factor = prefix_of("N*m*s/rad", max(sizes))
        each = [
            phrase("{size} at {speed:.1f}", size=NumberText(size / factor, DIGITS), speed=speed * RPM)
            for size, speed in zip(sizes, speeds.tolist(), strict=True)
        ]
        yield phrase(
            "Absolute damping of {name} at the critical speeds [rpm], {law}: {values} {unit}.",
            name=as_words(name),
            law=phrase(laws[name]),
            values=joined(", ", each),
            unit=unit(prefix + "N*m*s/rad"),
        )


def coupling_dampings(case: Case, records: Sequence[JudgedCritical]) -> Iterator[str]:
    """Yield a sentence for each spring with a loss factor as of rubber: viscous damping that loses as much, by mode."""
    speeds = case.drivetrain.definition.speeds
    met = [record.critical for record in records if math.isfinite(record.critical.natural_speed)]
    if speeds is None or not met:
        return
    dampings: dict[str, dict[int, dict[float, float]]] = {}
    at = np.array([critical.natural_speed for critical in met])
    for rig, places in drivetrains_at_speeds(case.drivetrain, speeds.of, at):
        for owner, law in zip(rig.assembly.owners, rig.assembly.laws, strict=True):
            for critical in (met[place] for place in places.tolist()):
                omega = 2 * math.pi * critical.mode.natural_frequency
                stiffness = complex(law.stiffness) * (1 + 1j * float(law.loss_factor))
                if law.table is not None:
                    stiffness += complex(law.table.kappa(np.array([omega]))[0])
                # k (1 + j eta) = k + j omega c: the same loss in each cycle at this frequency.
                if stiffness.imag >= LEAST_LOSS * stiffness.real > 0:
                    dampings.setdefault(owner, {}).setdefault(critical.mode.number, {})[critical.natural_speed] = (
                        stiffness.imag / omega
                    )
    for name, by_mode in dampings.items():
        prefix, factor = prefix_of("N*m*s/rad", max(size for those in by_mode.values() for size in those.values()))
        each = []
        for mode, sizes in by_mode.items():
            texts = {speed: str(NumberText(size / factor, DIGITS)) for speed, size in sizes.items()}
            if len(set(texts.values())) == 1:
                each.append(phrase("{size} in mode {mode}", size=next(iter(texts.values())), mode=mode))
            else:
                template = "{size} at {speed:.1f} rpm"
                each += [phrase(template, size=size, speed=speed * RPM) for speed, size in texts.items()]
        yield phrase(
            "Damping of {name} as viscous at the critical speeds, c = η k/ω: {values} {unit}.",
            name=as_words(name),
            values=joined(", ", each),
            unit=unit(prefix + "N*m*s/rad"),
        )


def cancelling_sources(records: Sequence[JudgedCritical]) -> Iterator[str]:
    """Yield the sentence on orders of several sources at one frequency whose sum is much less than the largest."""
    cancelling: dict[tuple[str, int], str] = {}
    for record in records:
        if record.point is None:
            continue
        summed = next(those for those in record.point.check.summed if record.line in those.places)
        largest = max(record.point.order((line,)) for line in summed.places)
        share = record.point.order(summed.places) / largest if largest else 1.0
        if len(summed.places) > 1 and share < CANCELLING_SOURCES:
            mode = record.critical.mode.number
            template = "{order}, mode {mode} ({share:.2g} % of the largest)"
            text = phrase(template, order=as_words(summed.name), mode=mode, share=100 * share)
            cancelling.setdefault((summed.name, mode), text)
    if cancelling:
        yield phrase(
            "Sources at one frequency cancel each other: {names}. What is measured is the sum, in the row that names "
            "them all; rows of single sources are what each of them would make alone.",
            names=joined("; ", list(cancelling.values())),
        )


def cancelling_cylinders(subject: ReportData, records: Sequence[JudgedCritical]) -> Iterator[str]:
    """Yield the sentence on orders whose cylinders cancel each other on a mode, so that their force is small."""
    cancelling, excitations = [], subject.normal_case.drivetrain.definition.excitations
    for record in records:
        star = record.critical.star
        if star is None or record.critical.case or not isinstance(excitations[star.excitation], ReciprocatingEngine):
            continue
        # In phase, the vectors of the star would add up to the sum of their lengths.
        whole = float(abs(star.vectors).sum())
        if abs(star.sum) < CANCELLING * whole:
            template = "{order}, mode {mode} ({share:.2g} %)"
            share = 100 * abs(star.sum) / whole
            cancelling.append(
                phrase(template, order=as_words(record.name), mode=record.critical.mode.number, share=share)
            )
    if cancelling:
        yield phrase(
            "Cylinders that are alike cancel each other: {names} of what they would make in phase. Differences between "
            "cylinders raise these most.",
            names=joined("; ", cancelling),
        )


def places_words(records: Sequence[JudgedCritical]) -> str:
    """Text with order, mode and critical speed in rpm of some critical speeds."""
    named = [
        phrase(
            "{order}, mode {mode} at {speed:.1f}",
            order=as_words(record.name),
            mode=record.critical.mode.number,
            speed=record.critical.natural_speed * RPM,
        )
        for record in records[:MOST_NAMED]
    ]
    more = len(records) - MOST_NAMED
    return joined(", ", [*named, *([phrase("… and {count} more", count=more)] if more > 0 else [])])


def _distances(subject: ReportData, shown: Sequence[JudgedCritical]) -> Iterator[Text]:
    """Sentence on how far the critical speeds listed lie from rated speed, the nearest of each order; or nothing."""
    speeds = subject.model.definition.speeds
    if speeds is None or not speeds.rated:
        return
    nearest: dict[str, float] = {}
    modes: dict[str, int] = {}
    for record in shown:
        off = record.critical.natural_speed / speeds.rated - 1
        if abs(off) < abs(nearest.get(record.name, math.inf)):
            nearest[record.name], modes[record.name] = off, record.critical.mode.number
    closest = sorted(nearest.items(), key=lambda pair: abs(pair[1]))
    shares = [f"{round(100 * off, 1) + 0.0:+.1f}".replace("-", "\N{MINUS SIGN}") for _, off in closest]
    template = "{order}, mode {mode}: {share} %"
    each = [
        phrase(template, order=as_words(name), mode=modes[name], share=share)
        for (name, _), share in zip(closest, shares, strict=True)
    ]
    if each:
        yield (
            phrase(
                "Distance of the critical speeds from rated speed, {speed:.6g} rpm: {distances}.",
                speed=speeds.rated * RPM,
                distances=joined("; ", each),
            ),
        )
