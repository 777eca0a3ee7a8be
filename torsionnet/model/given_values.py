"""Values that an element gives, one by one, with those of nested entries."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from torsionnet.base.entries.composite import Typed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import NumberTable
from torsionnet.base.entries.spec import Flag, Spec
from torsionnet.model.element_base.element_entries import NodeName, NodePair, ReferenceNode

if TYPE_CHECKING:
    from torsionnet.model.elements import Element

REMARKS = ("description", "enabled")
"""Names of the entries that tables show in their column of remarks."""


def given(element: Element) -> Iterator[tuple[str, Spec[object], Any]]:
    """Name, specification and value of the entries that an element gives, but nodes and remarks.

    Nested names as ``silicone.moduli``.
    """
    for name, (spec, value) in element.scalars().items():
        if not has_own_column(name, spec):
            yield from _leaves(name, spec, value)


def has_own_column(name: str, spec: Spec[object]) -> bool:
    """Whether a table of elements shows the entry in a column of its own: nodes, and remarks."""
    nodes = isinstance(spec, NodeName | NodePair) and not isinstance(spec, ReferenceNode)
    return nodes or name in REMARKS


def _leaves(name: str, spec: Spec[object], value: Any) -> Iterator[tuple[str, Spec[object], Any]]:
    if isinstance(value, tuple) and value and all(isinstance(one, Declared) for one in value):
        for number, one in enumerate(value, 1):
            yield from _leaves(f"{name} {number}", spec, one)
    elif isinstance(value, Declared):
        if isinstance(spec, Typed):
            yield name, spec, value.kind
        for inner, of in value.specs():
            if (one := getattr(value, inner)) is not None:
                yield from _leaves(f"{name}.{inner}", of, one)
    else:
        yield name, spec, value


def in_words(spec: Spec[object], value: Any) -> str:
    """Text of an entry's value that is no number: yes or no, a word, or a list of words."""
    if isinstance(spec, Flag):
        return "yes" if value else "no"
    if isinstance(spec, NumberTable):
        return f"{len(value)} rows, {value[0][0]:g} to {value[-1][0]:g}"
    return _listed_values(value if isinstance(value, str) else spec.plain(value))


def _listed_values(plain: Any) -> str:
    if isinstance(plain, Mapping):
        return ", ".join(f"{name} {_listed_values(one)}" for name, one in plain.items())
    return ", ".join(map(_listed_values, plain)) if isinstance(plain, list | tuple) else str(plain)
