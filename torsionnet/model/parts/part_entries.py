"""Entries of models for their own parts, files of parts, the parts used, and the nodes at which these are joined."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from torsionnet.base.entries.composite import Listed, Named, Nested
from torsionnet.base.entries.spec import Schema, Text, single_name_fault
from torsionnet.base.errors import Fault
from torsionnet.base.expression_reading import check_name
from torsionnet.base.packages import imported
from torsionnet.model.element_base.element_entries import NodeName

if TYPE_CHECKING:
    from torsionnet.model.parts.part import Part

PLAIN_NAME_SCHEMA: Schema = {"pattern": "^[A-Za-z][A-Za-z0-9_]*$"}
"""JSON Schema of a name without dots."""


def prefix_fault(name: str) -> Fault | str | None:
    """Fault that a name is not allowed for a use, as names of parameters begin with it, or None."""
    return single_name_fault(name) or check_name(name)


USE = Named(
    "parts put into this model, by the name that stands before those of all they hold",
    Nested(
        "a part, the nodes it is joined to and its values", partial(imported, "torsionnet.model.parts.use:Use"), "use"
    ),
    refused=prefix_fault,
    names=PLAIN_NAME_SCHEMA,
    form="{left: {part: half_shaft, at: {inner: dl, outer: hub}}}",
)
"""Specification of a model's entry ``use:``, the parts put into it."""
PORTS = Listed(
    "nodes at which a model is joined to others that use it as a part", NodeName("a node", False), "a list of nodes"
)
"""Specification of a model's entry ``ports:``, the nodes at which it is joined to others."""


class PartTable(Named["Part"]):
    """Entry of a model's parts by name.

    A part that could be read incompletely is kept, so that its uses are checked.
    """

    def read(self, raw: object) -> tuple[Mapping[str, Part], list[Fault]]:
        if not isinstance(raw, Mapping):
            return super().read(raw)
        table, faults = {}, list(self._name_faults(raw))
        for name, one in raw.items():
            part, found = self.of.read(one)
            faults += [fault.under(name) for fault in found]
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
    Nested("a model with ports", partial(imported, "torsionnet.model.parts.part:Part"), "part"),
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
