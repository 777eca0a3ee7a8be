"""Entries of models and parts for the parts used, their names, and the nodes at which they are joined."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.base.entries.composite import Listed, Named, Nested
from torsionnet.base.entries.spec import Schema, single_name_fault
from torsionnet.base.errors import Fault
from torsionnet.base.expression_reading import check_name
from torsionnet.model.element_base.element_entries import NodeName

if TYPE_CHECKING:
    from torsionnet.model.parts.use import Use

PLAIN_NAME_SCHEMA: Schema = {"pattern": "^[A-Za-z][A-Za-z0-9_]*$"}
"""JSON Schema of a name without dots."""


def _use() -> type[Use]:
    from torsionnet.model.parts.use import Use

    return Use


def prefix_fault(name: str) -> Fault | str | None:
    """Fault that a name is not allowed for a use, as names of parameters begin with it, or None."""
    return single_name_fault(name) or check_name(name)


USE = Named(
    "parts put into this model, by the name that stands before those of all they hold",
    Nested("a part, the nodes it is joined to and its values", _use, "use"),
    refused=prefix_fault,
    names=PLAIN_NAME_SCHEMA,
    form="{left: {part: half_shaft, at: {inner: dl, outer: hub}}}",
)
"""Specification of a model's entry ``use:``, the parts put into it."""
PORTS = Listed(
    "nodes at which a model is joined to others that use it as a part", NodeName("a node", False), "a list of nodes"
)
"""Specification of a model's entry ``ports:``, the nodes at which it is joined to others."""
