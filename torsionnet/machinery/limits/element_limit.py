"""Base of limits of torque, twist and heat: the element concerned, and the source of the values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import EntryPath, Fault, ModelError
from torsionnet.machinery.limits.evidence import Evidence
from torsionnet.machinery.limits.limit import Limit, LimitLine, line_without_data
from torsionnet.machinery.limits.subject import LimitSubject
from torsionnet.model.catalogues.catalogue_values import cell_value
from torsionnet.model.channels import Sensor
from torsionnet.model.element_base.element_entries import ElementName
from torsionnet.model.elements import Element


@dataclass(frozen=True, kw_only=True)
class ElementLimit(Limit):
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
        found: dict[str, Any] = {}
        closed = {"element", "source", *self._stated_otherwise()}
        for name, spec in self.specs():
            cell = row.cell(name)
            if cell is not None and name not in closed and getattr(self, name) == defaults[name]:
                found[name] = cell_value(cell, spec, faults)
        if faults:
            raise ModelError(faults, row.file)
        if found and self.source == defaults["source"]:
            found["source"] = f"catalogue {row}"
        return replace(self, **found)

    def _stated_otherwise(self) -> set[str]:
        """Names of entries that would repeat in another way what given entries of the limit say."""
        given = [way for way in self.alternatives if any(getattr(self, name) is not None for name in way)]
        return {name for way in self.alternatives if given and way not in given for name in way}

    def unfit(self, subject: LimitSubject) -> Iterator[Fault]:
        del subject
        if self.criteria and all(getattr(self, key) is None for key in self.criteria):
            yield Fault(f"nothing is limited; give one of {', '.join(self.criteria)}", on_key=True)

    def total(self, line: LimitLine, mean: Sensor, evidence: Evidence) -> LimitLine:
        """Limit line with the absolute mean value plus the half range of vibration at every speed.

        No speed may exceed its limit.
        """
        found = evidence.mean(mean)
        if found is None:
            return line_without_data(line.criterion, f"the mean value is not known: {evidence.why_no_mean}")
        return replace(line, values=np.abs(found) + line.values, in_passing=True)


def constant_over_speed(value: float, evidence: Evidence) -> Any:
    """Array of one value in its own unit at every speed, shape (n_speeds,)."""
    return np.full(len(evidence.speeds), float(value))
