"""Entries that name nodes and elements of a model, and a catalogue with the size in it.

Here as well: base class of entries with several values of one kind; base class of entries with several quantities of
different kinds; entry for the teeth counts of a gear pair.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from numbers import Integral
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from torsionnet.base.entries.spec import EntryError, Json, Plural, Renaming, Schema, Spec, Stored_co, Text, name_fault
from torsionnet.base.errors import EntryPath, Fault, got
from torsionnet.base.expressions import Expression, Number
from torsionnet.model.element_base.laws import GROUND, Values

if TYPE_CHECKING:
    from torsionnet.model.catalogues.catalogue import CatalogueRow


@dataclass(frozen=True, eq=False, repr=False)
class NodeName(Spec[str]):
    """Entry for the node to which a port of an element is attached."""

    allow_ground: bool = True

    def coerce(self, raw: object) -> str:
        if not isinstance(raw, str) or not raw:
            raise EntryError(Fault(f"expected the name of a node, {got(raw)}", kind="not-a-node"))
        fault = name_fault(raw)
        if fault:
            raise EntryError(fault)
        if raw == GROUND and not self.allow_ground:
            raise EntryError("ground does not move; attach this to a node", kind="grounded-node")
        return raw

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.node(value)

    def schema(self) -> Schema:
        return {"type": "string", "description": self.description}

    @property
    def accepted(self) -> str:
        return "str"


NODE, TURNING_NODE = NodeName("a node"), NodeName("a node that turns", allow_ground=False)
"""Entries for a node within other entries."""


@dataclass(frozen=True, eq=False, repr=False)
class ElementName(Text):
    """Entry for the name of an element of the model."""

    what: str = "the name of an element"

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.element(value)


class NodeText(Text):
    """Entry for the name of a node, or nothing."""

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.node(value) if value else value


@dataclass(frozen=True, eq=False, repr=False)
class PlaceOnElement(Text):
    """Entry for a port of an element, or the node there."""

    element: str = ""

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.at(self.element, value)


@dataclass(frozen=True, eq=False, repr=False)
class ReferenceNode(NodeName):
    """Entry for a node of the shaft at whose speed values are quoted, which is no port of the element."""

    allow_ground: bool = False


class NodePair(Spec[tuple[str, str]]):
    """Entry for two nodes, of which the first defines the sign of twist and torque."""

    def coerce(self, raw: object) -> tuple[str, str]:
        if isinstance(raw, str) or not isinstance(raw, Sequence) or len(raw) != 2:
            ends: Any = [raw] if isinstance(raw, str) else raw
            alone = isinstance(ends, Sequence) and len(ends) == 1 and isinstance(ends[0], str)
            ground = f"; to the ground: [{ends[0]}, ground]" if alone else ""
            raise EntryError(Fault(f"expected two nodes [first, second], {got(raw)}{ground}", kind="not-a-node"))
        names: list[str] = []
        for index, node in enumerate(raw):
            try:
                names.append(NODE.coerce(node))
            except EntryError as error:
                raise EntryError(error.fault.under(index)) from None
        if names[0] == names[1]:
            raise EntryError(
                f'both ends are on node "{names[0]}"; the element would do nothing', (1,), kind="same-node"
            )
        return (names[0], names[1])

    def renamed(self, value: Any, names: Renaming) -> Any:
        return (names.node(value[0]), names.node(value[1]))

    def plain(self, value: Any) -> Json:
        return list(value)

    def schema(self) -> Schema:
        return {
            "type": "array",
            "items": {"type": "string"},
            "minItems": 2,
            "maxItems": 2,
            "description": self.description,
        }

    @property
    def accepted(self) -> str:
        return "TwoNames"


One_co = TypeVar("One_co", covariant=True)
"""Type variable of the form in which a single value is stored."""


@dataclass(frozen=True, eq=False, repr=False)
class MultipleValues(Plural[tuple[Stored_co, ...]], Generic[Stored_co, One_co]):
    """Base class of entries with several values, each of the kind of the specification ``of``."""

    of: Spec[One_co]
    example_text: str
    """Example of the entry for messages that it is missing or wrong."""
    fewest: int = 2

    absent: ClassVar[Any] = ()

    @property
    def example(self) -> str:
        return self.example_text

    def form_error(self, raw: object) -> EntryError:
        return EntryError(f"expected {self.example_text}, {got(raw)}", kind="wrong-form")


class QuantityGroup(Spec[Stored_co]):
    """Base class of entries with several quantities of different kinds, as the stages of a spring."""

    def quantities(self, value: Any) -> Iterator[tuple[EntryPath, Spec[object], Expression, str]]:
        """Path, specification, expression and dimension name of every quantity in the stored value."""
        raise NotImplementedError

    def expressions(self, value: Any) -> tuple[tuple[EntryPath, Expression, str], ...]:
        return tuple((path, expression, dimension) for path, _, expression, dimension in self.quantities(value))


def exact_or_value(expression: Expression, value: Values) -> Any:
    """Value of a quantity: an exact fraction of a plain number, else a number of the algebra of ``value``."""
    return expression.value if isinstance(expression, Number) else value(expression)


def shown(expression: Expression | None, number: Any) -> str:
    """Text of a quantity for a message: as it is written, with the value of an expression behind it.

    >>> from torsionnet.base.expressions import Name
    >>> shown(Name("T_1"), Fraction(5, 2))
    'T_1 = 2.5'
    """
    plain = f"{float(number):g}" if isinstance(number, int | float | Fraction) else "one of several values"
    if expression is None:
        return plain
    return f"{expression} = {plain}" if expression.names else str(expression)


MOST_TEETH = 1_000_000
"""Largest teeth count of a gear, as a larger number is a slip or a ratio, which has an entry of its own."""


class Teeth(Spec[tuple[int, int]]):
    """Entry for the teeth counts of a gear pair.

    One negative count marks opposite senses of rotation (an external mesh).
    """

    def coerce(self, raw: object) -> tuple[int, int]:
        if isinstance(raw, str) or not isinstance(raw, Sequence) or len(raw) != 2:
            raise EntryError(f"expected two teeth counts [z1, z2], {got(raw)}", kind="wrong-count")
        for index, count in enumerate(raw):
            if isinstance(count, bool) or not isinstance(count, Integral) or count == 0:
                raise EntryError(
                    f"a teeth count is a whole number other than zero, {got(count)}", (index,), kind="not-a-number"
                )
            if abs(int(count)) > MOST_TEETH:
                raise EntryError(
                    f"no gear has more than {MOST_TEETH} teeth; for a ratio give ratio:", (index,), kind="too-large"
                )
        return (int(raw[0]), int(raw[1]))

    def plain(self, value: Any) -> Json:
        return list(value)

    def schema(self) -> Schema:
        return {
            "type": "array",
            "items": {"type": "integer"},
            "minItems": 2,
            "maxItems": 2,
            "description": self.description,
        }

    @property
    def accepted(self) -> str:
        return "tuple[int, int] | list[int]"


CATALOGUE, SIZE = "catalogue", "size"
"""Names of the entries of an element for its catalogue and its size."""


class CatalogueEntry(Spec["CatalogueRow"]):
    """Entry of the name of a catalogue: a file beside the model, or one that comes with the package."""

    def coerce(self, raw: object) -> CatalogueRow:
        from torsionnet.model.catalogues.catalogue import CatalogueRow

        if isinstance(raw, CatalogueRow):
            return raw
        raise EntryError(
            f"by its name a catalogue is found beside a model file; in Python give Path({raw!r})", kind="missing-file"
        )

    def plain(self, value: Any) -> str:
        return str(value.file)

    def schema(self) -> Schema:
        return {"type": "string", "description": self.description}

    @property
    def accepted(self) -> str:
        catalogue = "torsionnet.model.catalogues.catalogue"
        return f"pathlib.PurePath | {catalogue}.Catalogue | {catalogue}.CatalogueRow"


class SizeName(Spec[str]):
    """Entry of a size in a catalogue, which may look like a number."""

    def coerce(self, raw: object) -> str:
        if isinstance(raw, bool) or not isinstance(raw, str | int | float):
            raise EntryError(f"expected the size as the catalogue names it, {got(raw)}", kind="wrong-form")
        return str(raw)

    def schema(self) -> Schema:
        return {"type": ["string", "number"], "description": self.description}

    @property
    def accepted(self) -> str:
        return "str | float"
