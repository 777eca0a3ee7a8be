"""Mentions of nodes, parameters, elements and other things in the entries of a model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

from torsionnet.base.entries.spec import Renaming, Spec
from torsionnet.base.errors import EntryPath, TorsionnetError

CHANGED = "changed entry"
"""Kind of a mention that an alternative changes, before it is known whether that is a parameter or an entry."""


class Mention(NamedTuple):
    """Name of something of a kind, as an entry holds it; of a thing in a part with the name of that part."""

    kind: str
    name: str
    part: str = ""


@dataclass(frozen=True)
class Scope:
    """Model or part within which names are unique, by its path in the document and its data."""

    path: EntryPath
    data: Mapping[str, Any]

    def table(self, section: str) -> Mapping[str, Any]:
        """Entries of a section by name, as they are written; empty where there is no such section."""
        found = self.data.get(section)
        return found if isinstance(found, Mapping) else {}

    @cached_property
    def recorder(self) -> Recorder:
        """Recorder of the names that entries of the model or part mention."""
        channels = {*self.table("sensors"), *self.table("inputs")}
        return Recorder("", {}, channels, PortTable(self), {*self.table("excitations")})


@dataclass(frozen=True)
class PortTable(Mapping[str, Mapping[str, str]]):
    """Table of the ports of each element with their nodes, made for an element when it is asked for."""

    scope: Scope

    def __getitem__(self, name: str) -> Mapping[str, str]:
        from torsionnet.model.sections import ELEMENTS

        elements, _ = ELEMENTS.read({name: self.scope.table("elements")[name]})
        return elements[name].ports if name in elements else {}

    def __iter__(self) -> Iterator[str]:
        return iter(self.scope.table("elements"))

    def __len__(self) -> int:
        return len(self.scope.table("elements"))


@dataclass(frozen=True, eq=False)
class Recorder(Renaming):
    """Renaming that leaves all names as they are and keeps a list of them."""

    found: list[Mention] = field(default_factory=list)

    def _kept(self, kind: str, name: str, part: str = "") -> str:
        self.found.append(Mention(kind, name, part))
        return name

    def own(self, name: str) -> str:
        return self._kept("parameter", name)

    def element(self, name: str) -> str:
        return self._kept("element", name)

    def parameter(self, name: str) -> str:
        return self._kept("parameter", name)

    def channel(self, name: str) -> str:
        return self._kept("channel", name)

    def excitation(self, name: str) -> str:
        return self._kept("excitation", name)

    def part(self, name: str) -> str:
        return self._kept("part", name)

    def port(self, part: str, name: str) -> str:
        return self._kept("node", name, part)

    def part_parameter(self, part: str, name: str) -> str:
        return self._kept("parameter", name, part)

    def changed_entry(self, name: str) -> str:
        return self._kept(CHANGED, name)

    def configuration(self, name: str) -> str:
        for choice in name.split(","):
            axis, sign, alternative = choice.rpartition("=")
            if sign:
                self._kept("axis", axis.strip())
            self._kept("configuration", alternative.strip(), axis.strip())
        return name

    def node(self, name: str) -> str:
        return self._kept("node", name)

    def mentions(self, spec: Spec[Any], raw: object) -> list[Mention]:
        """Mentions in the value of an entry as a file gives it, in the order of the text; none where it is faulty."""
        self.found.clear()
        try:
            value, faults = spec.read(raw)
            if value is not None and not faults:
                spec.renamed(value, self)
        except (TorsionnetError, ArithmeticError):  # as of sizes that only the reading of the whole model refuses
            self.found.clear()
        return list(self.found)
