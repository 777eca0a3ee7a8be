"""Base of limits of torque, twist and heat: the element concerned, and the source of the values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from torsionnet.base.entries.composite import given_entries, one_at_most
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Flag, Spec, Text, entry
from torsionnet.base.errors import EntryPath, Fault, ModelError
from torsionnet.base.phrases import joined, phrase
from torsionnet.machinery.limits.evidence import Evidence, LimitSubject
from torsionnet.machinery.limits.limit import LimitLine, line_without_data, register_rule
from torsionnet.machinery.limits.speed_band import InSpeedBand
from torsionnet.machinery.verdicts.limit_verdict import RuleText
from torsionnet.model.catalogues.catalogue_reading import cell_value
from torsionnet.model.channels import Sensor, port_fault
from torsionnet.model.element_base.element_entries import ElementName, PlaceOnElement
from torsionnet.model.elements import Element


@dataclass(frozen=True, kw_only=True)
class ElementLimit(InSpeedBand):
    """Base of limits with allowed values for some of an element's torque, twist and heat."""

    criteria: ClassVar[tuple[str, ...]] = ()
    """Names of the entries of a limit of which at least one has to be given."""
    alternatives: ClassVar[tuple[tuple[str, ...], ...]] = ()
    """Groups of entry names that state the same limit in different ways: with one group given, a catalogue adds none of
    the others."""

    element: str = entry(ElementName("what it is about"))
    source: str = entry(Text("who states the values, and where"), "values given by the user")

    @property
    def of(self) -> str:
        return str(self.element)

    @property
    def named(self) -> tuple[tuple[EntryPath, str, str], ...]:
        return ((("element",), "element", self.element),)

    @property
    def torque(self) -> Sensor:
        """Sensor of the element's torque at the port that defines its sign."""
        return Sensor("torque", self.element)

    @property
    def twisting(self) -> Sensor:
        """Sensor of the twist of the limited element."""
        return Sensor("twist", self.element)

    def fitted(self, elements: Mapping[str, Element]) -> Self:
        """Copy of the limit whose missing entries come from the catalogue of its element, if it has one."""
        row = elements[self.element].catalogue if self.element in elements else None
        if row is None:
            return self
        faults: list[Fault] = []
        defaults = self.defaults()
        entries: dict[str, Any] = {}
        closed = {"element", "source", *self._stated_otherwise()}
        for name, spec in self.specs():
            cell = row.cell(name)
            if cell is not None and name not in closed and getattr(self, name) == defaults[name]:
                entries[name] = cell_value(cell, spec, faults)
        if faults:
            raise ModelError(faults, row.file)
        if entries and self.source == defaults["source"]:
            entries["source"] = f"catalogue {row}"
        return replace(self, **entries)

    def _stated_otherwise(self) -> set[str]:
        """Names of entries that would repeat in another way what given entries of the limit say."""
        given = [way for way in self.alternatives if any(getattr(self, name) is not None for name in way)]
        return {name for way in self.alternatives if given and way not in given for name in way}

    def unfit(self, subject: LimitSubject) -> Iterator[Fault]:
        yield from super().unfit(subject)
        if self.criteria and all(getattr(self, key) is None for key in self.criteria):
            yield Fault(
                f"nothing is limited; give one of {', '.join(self.criteria)}", on_key=True, kind="missing-entry"
            )

    def total(self, line: LimitLine, mean: Sensor, evidence: Evidence) -> LimitLine:
        """Limit line with the absolute mean value plus the half range of vibration at every speed.

        No speed may exceed its limit.
        """
        mean_values = evidence.mean(mean)
        if mean_values is None:
            return line_without_data(line.criterion, f"the mean value is not known: {evidence.why_no_mean}")
        # |T_mean| + half range bounds |T| whatever the sense of the mean torque.
        return replace(line, values=np.abs(mean_values) + line.values, in_passing=True)


def constant_over_speed(value: float, evidence: Evidence) -> Any:
    """Array of one value in its own unit at every speed, shape (n_speeds,)."""
    return np.full(len(evidence.speeds), float(value))


# Limits of gears on vibratory torque against mean torque, and on gear hammer.


@register_rule
@dataclass(frozen=True, kw_only=True)
class GearLimit(ElementLimit):
    """Vibratory torque of gear teeth, as a share of the mean torque at rated speed; gear hammer where torque reverses.

    The share is of full load, the full transmission torque: of the model as written where a condition, as zero pitch or
    one engine alone, transmits less. Teeth part and hammer where the half range is larger than the mean torque at the
    same speed.

    Examples
    --------
    >>> GearLimit(element="mesh", vibratory_share="30 %").vibratory_share
    0.3
    """

    kind: ClassVar[str] = "gear"

    at: str | None = entry(Text("port or node whose torque is meant; default: the first", "the name of a node"), None)
    vibratory_share: float | None = entry(
        Value("vibratory torque over mean torque at rated speed", "1", exclusive=True), None
    )
    rated_torque: float | None = entry(Value("that mean torque; default: of the load", "torque", exclusive=True), None)
    vibratory_torque: float | None = entry(
        Value("vibratory torque allowed, instead of a share", "torque", exclusive=True), None
    )
    hammer: bool = entry(Flag("whether torque must not reverse"), True)

    def contradictions(self) -> list[Fault]:
        bounds = "vibratory_share", "vibratory_torque"
        if not (given_entries(self, *bounds) or self.hammer):
            return [
                Fault(
                    "nothing is limited; give vibratory_share, vibratory_torque or hammer: true",
                    on_key=True,
                    kind="missing-entry",
                )
            ]
        return one_at_most(self, *bounds)

    @classmethod
    def spec_beside(cls, name: str, spec: Spec[Any], entries: Mapping[str, Any]) -> Spec[Any]:
        return PlaceOnElement(spec.description, element=str(entries.get("element"))) if name == "at" else spec

    def unfit(self, subject: LimitSubject) -> Iterator[Fault]:
        yield from super().unfit(subject)
        reason = port_fault(subject.elements[self.element], self.at) if self.at else None
        if reason:
            yield replace(reason, path=("at",))
        needs = self.vibratory_share is not None and self.rated_torque is None
        if needs and subject.rated is None:
            text = "a share is of the mean torque at rated speed: give rated_torque, or speeds: {rated: 750 rpm}"
            yield Fault(text, ("vibratory_share",), on_key=True, about="speeds", kind="missing-entry")

    @property
    def torque(self) -> Sensor:
        return Sensor("torque", self.element, self.at)

    @property
    def of_full_load(self) -> bool:
        return self.vibratory_share is not None and self.rated_torque is None

    def order_sensors(self, subject: LimitSubject) -> list[Sensor]:
        del subject
        return [self.torque]

    def mean_sensors(self, subject: LimitSubject) -> list[Sensor]:
        del subject
        return [self.torque]

    def vibratory_sensors(self, criterion: str, subject: LimitSubject) -> tuple[list[Sensor], float] | None:
        del criterion, subject
        return [self.torque], 1.0

    def rule_text(self, evidence: Evidence) -> RuleText:
        del evidence
        parts = []
        if self.vibratory_share is not None:
            share = 100 * self.vibratory_share
            parts.append(phrase("T_v <= {share:g} % of the mean torque at rated speed and full load", share=share))
        if self.vibratory_torque is not None:
            parts.append(f"T_v <= {self.vibratory_torque:g} N*m")
        if self.hammer:
            parts.append(phrase("no gear hammer: T_v <= mean torque at the same speed"))
        formula = joined("; ", [*parts, phrase("T_v: half range of the sum of all orders")])
        return RuleText(self.source, formula, "tooth root and flank strength, backlash and its noise in other gears")

    def lines(self, evidence: Evidence) -> Iterator[LimitLine]:
        size, orders, mean = evidence.size([self.torque]), evidence.orders([self.torque]), evidence.mean(self.torque)
        quantity = "vibratory torque, half range"
        if self.vibratory_torque is not None:
            allowed = constant_over_speed(self.vibratory_torque, evidence)
            yield LimitLine("T_v", quantity, "N*m", size, allowed, (), orders)
        if self.vibratory_share is not None:
            rated = self._rated_torque(evidence)
            if rated is None:
                yield line_without_data("T_v", self._unknown(evidence))
            else:
                allowed = constant_over_speed(self.vibratory_share * rated, evidence)
                remarks = (phrase("mean torque at rated speed and full load {torque:.6g} N*m", torque=rated),)
                yield LimitLine("T_v", quantity, "N*m", size, allowed, remarks, orders)
        # Teeth part where the vibratory torque exceeds the mean torque of the same speed, so that torque changes its
        # sign.
        if self.hammer:
            if mean is None:
                yield line_without_data("hammer", self._unknown(evidence))
            elif self.torque in evidence.idle:
                yield replace(line_without_data("hammer", IDLE), absent=True)
            else:
                yield LimitLine("hammer", quantity, "N*m", size, np.abs(mean), (), orders)

    def lines_in_passing(self, evidence: Evidence) -> list[LimitLine]:
        # Teeth of an idling gear hammer in every start.
        return [line for line in super().lines_in_passing(evidence) if line.criterion != "hammer"]

    def _rated_torque(self, evidence: Evidence) -> float | None:
        mean = evidence.rated_means.get(self.torque)
        if self.rated_torque is not None:
            return float(self.rated_torque)
        return abs(mean) if mean else None

    def _unknown(self, evidence: Evidence) -> str:
        if not evidence.why_no_mean and self.torque in evidence.rated_means:
            return "it transmits no mean torque at rated speed, here or as written; give rated_torque"
        return f"the mean torque is not known: {evidence.why_no_mean or 'the rated speed is not among the speeds'}"


IDLE = "it transmits no mean torque in this condition: its teeth part in any vibration"
"""Remark on the hammer of a mesh that idles in a condition, as that of an engine that is declutched."""
