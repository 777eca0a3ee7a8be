"""Entries of a model for its own parts and the files of parts that it includes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from torsionnet.base.entries.composite import Listed, Named, Nested
from torsionnet.base.entries.spec import Text, single_name_fault
from torsionnet.base.errors import Fault
from torsionnet.model.parts.part_entries import PLAIN_NAME_SCHEMA

if TYPE_CHECKING:
    from torsionnet.model.parts.part import Part


def _part() -> type[Part]:
    from torsionnet.model.parts.part import Part

    return Part


class PartTable(Named["Part"]):
    """Entry of a model's parts by name.

    A part that could be read incompletely is kept, so that its uses are checked.
    """

    def read(self, raw: object) -> tuple[Mapping[str, Part], list[Fault]]:
        if not isinstance(raw, Mapping):
            return super().read(raw)
        table, faults = {}, list(self._name_faults(raw))
        for name, raw_part in raw.items():
            part, wrong = self.of.read(raw_part)
            faults += [fault.under(name) for fault in wrong]
            if part is not None and not single_name_fault(str(name)):
                table[str(name)] = part
        return table, faults

    def _name_faults(self, raw: Mapping[str, Any]) -> Iterator[Fault]:
        for name in raw:
            unfit = single_name_fault(str(name))
            if unfit:
                yield replace(unfit, path=(name,), on_key=True)


PARTS = PartTable(
    "models with ports, to be put in under use:, by name",
    Nested("a model with ports", _part, "part"),
    names=PLAIN_NAME_SCHEMA,
    form="{half_shaft: {ports: [inner, outer], elements: {...}}}",
)
"""Specification of a model's entry ``parts:``, its own parts by name."""
INCLUDE = Listed(
    "files beside this one or below with parts:, or models with ports:, which are parts under the name of their file",
    Text("the name of a file", "the name of a file"),
    "a list of files",
)
"""Specification of a model's entry ``include:``, the files of parts that it includes."""
