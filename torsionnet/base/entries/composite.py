"""Entries composed of other entries, as an object, a table by name, a list or a pair.

Here as well: checks that one of several alternative entries of an object is given, and not more.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, TypeAlias, TypeVar, cast

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.spec import (
    Json,
    Plural,
    Renaming,
    Schema,
    Spec,
    Stored_co,
    full_name,
    list_annotation,
    reference,
)
from torsionnet.base.errors import BRACKET, LEAVE_OUT, Fault, Remedy, fault_of, got, unfit_word

D = TypeVar("D", bound=Declared)
Kinds: TypeAlias = Callable[[], Mapping[str, type[D]]]


class Composite(Spec[Stored_co]):
    """Base of entries that are composed of other entries."""

    def read(self, raw: object) -> tuple[Stored_co | None, list[Fault]]:
        raise NotImplementedError


@dataclass(frozen=True, eq=False, repr=False)
class Nested(Composite[D]):
    """Entry that holds an object described by further entries.

    With ``shorthand`` a bare value stands for the entry of that name.

    ``name`` is that of its definition in the schema.
    """

    of: Callable[[], type[D]]
    name: str
    shorthand: str = ""
    optional: bool = False
    shown: str = ""

    @property
    def may_be_empty(self) -> bool:
        return self.optional

    @property
    def example(self) -> str:
        return self.shown or self.description

    def read(self, raw: object) -> tuple[D | None, list[Fault]]:
        cls = self.of()
        if self.shorthand and not isinstance(raw, Mapping | cls):
            value, faults = dict(cls.specs())[self.shorthand].read(raw)
            return (None, faults) if faults else cls.made({self.shorthand: value})
        return cls.read(raw)

    def entry_specs(self, raw: object) -> Mapping[Any, Spec[Any]]:
        return self.of().entry_specs(raw) if isinstance(raw, Mapping) else {}

    def key_names(self, raw: object) -> Mapping[Any, Spec[Any]]:
        return self.of().key_names(raw) if isinstance(raw, Mapping) else {}

    def renamed(self, value: Any, names: Renaming) -> Any:
        return value.renamed(names)

    def plain(self, value: Any) -> Json:
        data: Json = value.to_data()
        return data

    def schema(self) -> Schema:
        return reference(self.name)

    def definitions(self) -> Schema:
        cls = self.of()
        schema = cls.schema()
        if self.optional:
            schema["type"] = ["object", "null"]
        if self.shorthand:
            schema = {"anyOf": [dict(cls.specs())[self.shorthand].schema(), schema]}
        return {self.name: {**schema, "description": self.description}, **cls.definitions()}

    @property
    def accepted(self) -> str:
        of = full_name(self.of())
        short = f" | {dict(self.of().specs())[self.shorthand].accepted}" if self.shorthand else ""
        return f"{of} | Entries{short}"


@dataclass(frozen=True, eq=False, repr=False)
class Typed(Composite[D]):
    """Entry that holds an object of one of several classes, chosen by ``type:`` or another key."""

    kinds: Kinds[D]
    what: str
    name: str
    """Name under which the JSON Schema defines the entry; the names of the kinds begin with it."""
    shown: str = ""
    key: str = "type"

    @property
    def example(self) -> str:
        return self.shown or self.description

    def read(self, raw: object) -> tuple[D | None, list[Fault]]:
        known = self.kinds()
        kind = raw.get(self.key) if isinstance(raw, Mapping) else None
        if isinstance(raw, Mapping) and isinstance(kind, str) and kind in known:
            return known[kind].read({key: value for key, value in raw.items() if key != self.key})
        if self._is_one_of(known, raw):
            return cast("D", raw), []
        names = ", ".join(known)
        if not isinstance(raw, Mapping) or kind is None:
            return None, [
                Fault(
                    f"expected {{{self.key}: ..., ...}} with one of the {self.key}s {names}",
                    on_key=True,
                    kind="missing-entry",
                )
            ]
        text = f'no {self.what} {self.key} is named "{kind}"'
        return None, [unfit_word(text, str(kind), known, (self.key,), f"known: {names}")]

    @staticmethod
    def _is_one_of(known: Mapping[str, type[D]], raw: object) -> bool:
        """Whether the value is an object of one of the kinds, if possible without importing all of them."""
        if not isinstance(raw, Declared):
            return False
        return (raw.kind in known and isinstance(raw, known[raw.kind])) or isinstance(raw, tuple(known.values()))

    def entry_specs(self, raw: object) -> Mapping[Any, Spec[Any]]:
        cls = self._class_of(raw)
        return cls.entry_specs(raw) if cls and isinstance(raw, Mapping) else {}

    def key_names(self, raw: object) -> Mapping[Any, Spec[Any]]:
        cls = self._class_of(raw)
        return cls.key_names(raw) if cls and isinstance(raw, Mapping) else {}

    def _class_of(self, raw: object) -> type[D] | None:
        kind = raw.get(self.key) if isinstance(raw, Mapping) else None
        return self.kinds().get(kind) if isinstance(kind, str) else None

    def renamed(self, value: Any, names: Renaming) -> Any:
        return value.renamed(names)

    def plain(self, value: Any) -> Json:
        return {self.key: value.kind, **value.to_data()}

    def schema(self) -> Schema:
        return reference(self.name)

    def definitions(self) -> Schema:
        known = self.kinds()
        names = {kind: f"{self.name}_{kind.replace(' ', '_')}" for kind in known}
        rules: list[Json] = [
            {"if": {"properties": {self.key: {"const": kind}}, "required": [self.key]}, "then": reference(name)}
            for kind, name in names.items()
        ]
        word = {"enum": list(known), "description": self.description}
        schema: Schema = {
            self.name: {"type": "object", "properties": {self.key: word}, "required": [self.key], "allOf": rules}
        }
        for kind, cls in known.items():
            schema[names[kind]] = cls.schema(type_key=self.key)
            schema |= cls.definitions()
        return schema

    @property
    def accepted(self) -> str:
        return " | ".join([*map(full_name, self.kinds().values()), "Entries"])


@dataclass(frozen=True, eq=False, repr=False)
class Named(Composite[Mapping[str, Stored_co]], Plural[Mapping[str, Stored_co]]):
    """Entry that holds a table of entries by name."""

    of: Spec[Stored_co]
    refused: Callable[[str], Fault | str | None] = field(default=lambda _: None)
    """Function that returns why a name in the table is not allowed, or None where it is."""
    names: Schema = field(default_factory=dict)
    """JSON Schema that every name in the table has to fit."""
    form: str = "entries by name"
    fewest: int = 0
    keys: Spec[str] | None = None
    """Specification of the names in the table where these are names of other things, as of nodes."""

    absent: ClassVar[Any] = {}

    @property
    def may_be_empty(self) -> bool:
        return not self.fewest

    @property
    def example(self) -> str:
        return self.form

    def read(self, raw: object) -> tuple[Mapping[str, Stored_co], list[Fault]]:
        if not isinstance(raw, Mapping) or len(raw) < self.fewest:
            return {}, [Fault(f"expected {self.form}, {got(raw)}", kind="wrong-form")]
        table: dict[str, Stored_co] = {}
        faults: list[Fault] = []
        for name, entry in raw.items():
            reason = self.refused(str(name))
            if reason:
                faults.append(replace(fault_of(reason, "invalid-name"), path=(name,), on_key=True))
                continue
            empty = entry is None and self.of.may_be_empty
            value, wrong = (self.of.absent, []) if empty else self.of.read(entry)
            faults += [fault.under(name) for fault in wrong]
            if not wrong:
                table[str(name)] = cast("Stored_co", value)
        return table, faults

    def key_names(self, raw: object) -> Mapping[Any, Spec[Any]]:
        return dict.fromkeys(raw, self.keys) if self.keys is not None and isinstance(raw, Mapping) else {}

    def entry_specs(self, raw: object) -> Mapping[Any, Spec[Any]]:
        return dict.fromkeys(raw, self.of) if isinstance(raw, Mapping) else {}

    def renamed(self, value: Any, names: Renaming) -> Any:
        if self.keys is not None:
            return {self.keys.renamed(name, names): self.of.renamed(entry, names) for name, entry in value.items()}
        renamed = {name: self.of.renamed(entry, names) for name, entry in value.items()}
        return value if all(renamed[name] is value[name] for name in value) else renamed

    def plain(self, value: Any) -> Json:
        return {name: self.of.plain(entry) for name, entry in value.items()}

    def schema(self) -> Schema:
        kind: Any = "object" if self.fewest else ["object", "null"]
        schema: Schema = {"type": kind, "description": self.description, "additionalProperties": self.of.schema()}
        schema |= {"propertyNames": self.names} if self.names else {}
        return schema | ({"minProperties": self.fewest} if self.fewest else {})

    def definitions(self) -> Schema:
        return self.of.definitions()

    @property
    def accepted(self) -> str:
        return f"collections.abc.Mapping[str, {self.of.accepted}]"


@dataclass(frozen=True, eq=False, repr=False)
class Listed(Composite[tuple[Stored_co, ...]], Plural[tuple[Stored_co, ...]]):
    """Entry that holds a list of entries of one kind."""

    of: Spec[Stored_co]
    form: str = "a list"

    absent: ClassVar[Any] = ()

    def read(self, raw: object) -> tuple[tuple[Stored_co, ...], list[Fault]]:
        if not isinstance(raw, list | tuple):
            remedy = Remedy(BRACKET) if isinstance(raw, str) else None
            return (), [Fault(f"expected {self.form}, {got(raw)}", remedy=remedy, kind="wrong-form")]
        values: list[Any] = []
        faults: list[Fault] = []
        for index, entry in enumerate(raw):
            value, wrong = self.of.read(entry)
            faults += [fault.under(index) for fault in wrong]
            values += [] if wrong else [value]
        return tuple(values), faults

    def entry_specs(self, raw: object) -> Mapping[Any, Spec[Any]]:
        return dict.fromkeys(range(len(raw)), self.of) if isinstance(raw, list | tuple) else {}

    def renamed(self, value: Any, names: Renaming) -> Any:
        if not isinstance(value, tuple):  # a word that stands for a list
            return value
        renamed = tuple(self.of.renamed(part, names) for part in value)
        return value if all(new is old for new, old in zip(renamed, value, strict=True)) else renamed

    def plain(self, value: Any) -> Json:
        return [self.of.plain(entry) for entry in value]

    def schema(self) -> Schema:
        return {"type": "array", "items": self.of.schema(), "description": self.description}

    def definitions(self) -> Schema:
        return self.of.definitions()

    @property
    def accepted(self) -> str:
        return list_annotation(self.of.accepted)


@dataclass(frozen=True, eq=False, repr=False)
class PairOf(Composite[tuple[Stored_co, Stored_co]]):
    """Entry that holds two values ``[a, b]`` of one kind."""

    of: Spec[Stored_co]
    form: str = "two values [a, b]"

    def read(self, raw: object) -> tuple[tuple[Stored_co, Stored_co] | None, list[Fault]]:
        if not isinstance(raw, list | tuple) or len(raw) != 2:
            return None, [Fault(f"expected {self.form}, {got(raw)}", kind="wrong-form")]
        values, faults = Listed(self.description, self.of).read(raw)
        return (None if faults else (values[0], values[1])), faults

    def entry_specs(self, raw: object) -> Mapping[Any, Spec[Any]]:
        return dict.fromkeys(range(len(raw)), self.of) if isinstance(raw, list | tuple) else {}

    def renamed(self, value: Any, names: Renaming) -> Any:
        return (self.of.renamed(value[0], names), self.of.renamed(value[1], names))

    def plain(self, value: Any) -> Json:
        return [self.of.plain(part) for part in value]

    def schema(self) -> Schema:
        pair: Schema = {"type": "array", "items": self.of.schema(), "minItems": 2, "maxItems": 2}
        return {**pair, "description": self.description}

    @property
    def accepted(self) -> str:
        return list_annotation(self.of.accepted)


_COUNTS = {2: "two", 3: "three", 4: "four"}


def given_entries(owner: object, *names: str) -> list[str]:
    """Names of those entries, out of the ones asked about, that have a value."""
    values = ((name, getattr(owner, name)) for name in names)
    return [name for name, value in values if value is not None and value not in ((), {})]


def one_at_most(owner: object, *names: str, of: str = "") -> list[Fault]:
    """Faults, placed at the second one given, where more than one of the alternative entries has a value.

    ``of`` says of what, as "the damping".
    """
    given = given_entries(owner, *names)
    if len(given) < 2:
        return []
    text = f"{of} is given by {given[0]} or by {given[1]}" if of else f"give {given[0]} or {given[1]}"
    remedy = None if of else Remedy(LEAVE_OUT, keys=(given[0], given[1]))
    return [Fault(f"{text}, not both", (given[1],), on_key=True, remedy=remedy, kind="contradicting-entries")]


def superfluous(why: str, key: str) -> Fault:
    """Fault of an entry that is to be left out, for a reason."""
    return Fault(f"{why}; leave out {key}", (key,), on_key=True, remedy=Remedy(LEAVE_OUT), kind="needless-entry")


def one_exactly(owner: object, *names: str, of: str = "", form: str = "") -> list[Fault]:
    """Faults of an object that does not give exactly one of several alternative entries.

    ``form`` is an example of one.
    """
    if given_entries(owner, *names):
        return one_at_most(owner, *names, of=of)
    wanted = f"{', '.join(names[:-1])} or {names[-1]}, one of the {_COUNTS[len(names)]}"
    text = f"{of} is given by {wanted}" if of else f"give {wanted}"
    return [Fault(f"{text}: {form}" if form else text, on_key=True, kind="missing-entry")]
