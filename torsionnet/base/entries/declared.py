"""Base class of objects whose fields carry specifications, by which they are read, checked, written and described.

Here as well: version of the file format, the first entry of every file; folder of the file that is being read.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import MISSING, Field, fields, replace
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, Self

from torsionnet.base.entries.spec import EntryError, Json, Renaming, Schema, Spec, spec_of
from torsionnet.base.errors import (
    SEPARATE,
    WRITE,
    Fault,
    ModelError,
    Remedy,
    UsageError,
    got,
    unknown_key,
)
from torsionnet.base.registers import settle

FORMAT_VERSION = 1
"""Number of the version of the file format that this release reads and writes."""
KEY = "torsionnet"
"""Key under which a file states the version of its format."""
VERSION_SCHEMA: dict[str, str | int] = {"const": FORMAT_VERSION, "description": "version of the file format"}


def version_faults(data: Mapping[Any, Any], kind: str) -> list[Fault]:
    """Faults of a file whose format version is missing or unknown; ``kind`` says what it holds: a model, a fit."""
    version = data.get(KEY)
    if version is None:
        text = f"the first entry of a {kind} file is {KEY}: {FORMAT_VERSION}, the version of the format"
        return [Fault(text, kind="missing-entry", about=KEY)]
    if version != FORMAT_VERSION or isinstance(version, bool):
        shown = f"format {version}" if isinstance(version, int) and not isinstance(version, bool) else repr(version)
        text = f"{KEY}: is the version of the format, {FORMAT_VERSION} for this release; this is {shown}"
        known = Remedy(WRITE, str(FORMAT_VERSION)) if str(version) in ("1", "1.0") else None
        return [Fault(text, (KEY,), remedy=known, kind="wrong-version")]
    return []


class Declared:
    """Base of frozen dataclasses whose fields are entries (:func:`torsionnet.base.entries.spec.entry`)."""

    kind: ClassVar[str] = ""
    """Name of the kind of object in messages and in the schema; the value of ``type:`` where there are several
    kinds."""
    article: ClassVar[str] = ""
    """Name of the kind of object with its article, for messages that need one."""
    head: ClassVar[tuple[str, ...]] = ()
    """Keys of a file that identify its kind and are no entries, as the format version."""
    common: ClassVar[tuple[str, ...]] = ()
    """Names of the entries that belong to all kinds of object in a register, and so stand last."""
    form: ClassVar[str] = "{name: value, ...}"
    """Example of how the object is written in a file."""

    def __post_init__(self) -> None:
        faults = self.coerced() or self.contradictions()
        if faults:
            raise ModelError(faults, type(self).kind or self.article)

    def coerced(self) -> list[Fault]:
        """Faults of the fields that cannot be stored, while all others are brought to their stored form."""
        faults: list[Fault] = []
        defaults, settled = self.defaults(), dict[str, Any]()
        for declared, (name, spec) in zip(self.declared(), self.specs(), strict=True):
            raw, default, stored = getattr(self, name), declared.default, defaults[name]
            if raw is default or (raw is stored and default is not MISSING):
                settled[name] = stored
                continue
            try:
                settled[name] = spec.coerce(raw)
            except EntryError as error:
                faults += [fault.under(name) for fault in error.faults]
        settle(self, **settled)
        return faults

    def settle_absent(self) -> None:
        """Store the default of every entry that is not given, where the others have their stored form already."""
        settle(self, **{name: stored for name, stored in self.defaults().items() if getattr(self, name) is None})

    def contradictions(self) -> list[Fault]:
        """Faults of entries that are valid alone but contradict each other."""
        return []

    def unchecked(self, **changes: Any) -> Self:
        """Copy of the object with other values of some fields, as they are stored, and without what it has calculated.

        Nothing is checked: for what is known to be right, or may contradict the other entries.
        """
        copied = object.__new__(type(self))
        settle(copied, **{field.name: getattr(self, field.name) for field in fields(self)} | changes)  # type: ignore[arg-type]
        return copied

    @classmethod
    @cache
    def declared(cls) -> tuple[Field[Any], ...]:
        """Dataclass fields that carry a specification, in the order of the class; those common to all kinds last.

        These are given by name alone, or stand in ``common``.
        """
        own = [declared for declared in fields(cls) if "spec" in declared.metadata]  # type: ignore[arg-type]
        return tuple(sorted(own, key=lambda declared: (declared.kw_only is True, declared.name in cls.common)))

    @classmethod
    @cache
    def specs(cls) -> tuple[tuple[str, Spec[object]], ...]:
        """Name and specification of every entry, in the order of the fields."""
        return tuple((declared.name, declared.metadata["spec"]) for declared in cls.declared())

    @classmethod
    @cache
    def required(cls) -> tuple[str, ...]:
        """Names of the entries that have to be given."""
        return tuple(declared.name for declared in cls.declared() if declared.metadata["must"])

    @classmethod
    @cache
    def defaults(cls) -> Mapping[str, Any]:
        """Default of every entry in its stored form, by name."""
        stored = {name: spec.absent for name, spec in cls.specs()}
        for field, (name, spec) in zip(cls.declared(), cls.specs(), strict=True):
            if field.default not in (MISSING, None):
                # Texts that give nothing, truth values and objects of entries are in their stored form.
                is_stored = field.default == "" or isinstance(field.default, bool | Declared)
                stored[name] = field.default if is_stored else spec.coerce(field.default)
        return stored

    @classmethod
    def read(cls, raw: object) -> tuple[Self | None, list[Fault]]:
        """Object that a mapping of entries describes, None if anything in it is wrong, and every fault."""
        if isinstance(raw, cls):
            return raw, []
        if not isinstance(raw, Mapping):
            return None, [Fault(f"expected {cls.form}, {got(raw)}", kind="wrong-form")]
        values, faults = cls.read_entries(raw)
        return (None, faults) if faults else cls.made(values)

    @classmethod
    def made(cls, values: Mapping[str, Any]) -> tuple[Self | None, list[Fault]]:
        """Object made from values of its entries, or None and the faults of values that contradict each other."""
        try:
            return cls(**values), []
        except ModelError as error:
            return None, list(error.faults)
        except UsageError as error:
            return None, [replace(error.fault, on_key=True)]

    @classmethod
    def read_entries(cls, raw: Mapping[Any, Any]) -> tuple[dict[str, Any], list[Fault]]:
        """Values of the entries that could be read, by name, and every fault."""
        faults = cls.key_faults(raw)
        values: dict[str, Any] = {}
        for name, spec in cls.specs():
            if raw.get(name) is not None or (name in raw and name in cls.required() and not spec.may_be_empty):
                values[name], wrong = spec.read(raw[name])
                faults += [fault.under(name) for fault in wrong]
        return values, faults

    @classmethod
    def key_faults(cls, raw: Mapping[Any, Any], name: str = "") -> list[Fault]:
        """Faults of unknown keys, of missing entries, and of entries without a value."""
        specs, required = dict(cls.specs()), cls.required()
        known = [*cls.head, *specs]
        rest = f"{cls.article or cls.kind} has {', '.join(known)}"
        faults: list[Fault] = []
        at_home: set[str] = set()
        for key in raw:
            if key not in known:
                run_together = _run_together(key, known, raw) if raw[key] is None else None
                home = next((part for part, spec in specs.items() if key in spec.keys_within and part not in raw), None)
                if home is None:
                    fault = run_together or unknown_key(key, known, (key,), rest)
                    # A comma in a text without quotes makes a key without a value; one that is begun is like another.
                    if raw[key] is None and not fault.meant and fault is not run_together:
                        fault = unknown_key(key, known, (key,), f"text with a comma needs quotes; {rest}")
                    faults.append(fault)
                    continue
                # A way to give the value of an entry, which stands beside it instead of in it.
                at_home.add(home)
                from torsionnet.base.familiar_words import familiar_key

                _, advice = familiar_key(str(key), known)
                text = f"{key} is written within {home}: {advice or f'{home}: {{{key}: {raw[key]}}}'}"
                faults.append(Fault(text, (key,), on_key=True, kind="unknown-entry", about=str(key)))
        faults += [cls.missing(key, name) for key in required if key not in raw and key not in at_home]
        empty = [key for key, spec in specs.items() if key in raw and raw[key] is None and not spec.may_be_empty]
        for key in empty:
            if key not in required:
                text = f"{key} has no value; give one, or leave the entry out"
                faults.append(Fault(text, (key,), on_key=True, kind="empty-entry", about=key))
        return faults

    @classmethod
    def missing(cls, key: str, name: str = "") -> Fault:
        """Fault of a required entry that is not given."""
        called = f"{cls.article or cls.kind} {name}".rstrip()
        text = f"{called} needs {key}: {dict(cls.specs())[key].example}"
        return Fault(text, on_key=True, kind="missing-entry", about=key)

    @classmethod
    def spec_beside(cls, name: str, spec: Spec[Any], entries: Mapping[str, Any]) -> Spec[Any]:
        """Specification that says what an entry names, which for some depends on the entries beside it."""
        del name, entries
        return spec

    @classmethod
    def entry_specs(cls, raw: Mapping[Any, Any]) -> Mapping[Any, Spec[Any]]:
        """Specification of each entry of an object as a file gives it, by key."""
        return {name: cls.spec_beside(name, spec, raw) for name, spec in cls.specs() if name in raw}

    @classmethod
    def key_names(cls, raw: Mapping[Any, Any]) -> Mapping[Any, Spec[Any]]:
        """Specification of each key of the object that names another thing, as an element."""
        del raw
        return {}

    def renamed(self, names: Renaming) -> Self:
        """Copy of the object in which all names that it refers to are renamed."""
        changes = {}
        for name, spec in self.specs():
            value = getattr(self, name)
            renamed = value if value is None else self.spec_beside(name, spec, self.__dict__).renamed(value, names)
            if renamed is not value:
                changes[name] = renamed
        return replace(self, **changes) if changes else self  # type: ignore[type-var]

    def to_data(self) -> Json:
        """Plain data that describe the object in a file; entries with their default are left out."""
        return self.written_entries()

    def written_entries(self) -> dict[str, Json]:
        """Plain value of every entry of the object that differs from its default, by name."""
        defaults = self.defaults()
        required = self.required()
        return {
            name: spec.plain(value)
            for name, spec in self.specs()
            if (value := getattr(self, name)) is not None and (name in required or value != defaults[name])
        }

    @classmethod
    def schema(cls, *, type_key: str = "") -> Schema:
        """JSON Schema of an object of this class as a file holds it.

        ``type_key`` is the key, as ``type``, that names its kind.
        """
        summary = (cls.__doc__ or "").strip().splitlines()[0]
        head: Schema = {type_key: {"const": cls.kind, "description": summary}} if type_key else {}
        head |= dict.fromkeys(cls.head, VERSION_SCHEMA)
        properties = {declared.name: _with_default(declared) for declared in cls.declared()}
        return {
            "title": cls.kind or cls.article,
            "description": summary,
            "type": "object",
            "properties": head | properties,
            "required": [*head, *cls.required()],
            "additionalProperties": False,
        }

    @classmethod
    def definitions(cls) -> Schema:
        """Definitions that the JSON Schema of the class refers to, by name."""
        definitions: Schema = {}
        for _, spec in cls.specs():
            definitions |= spec.definitions()
        return definitions


def _with_default(declared: Field[Any]) -> Schema:
    spec = spec_of(declared)
    schema = {**spec.schema()}
    if "$ref" in schema:
        schema.setdefault("description", spec.description)
    default = declared.default
    return {**schema, "default": default} if isinstance(default, bool | int | float | str) and default != "" else schema


def _run_together(key: Any, known: Iterable[str], raw: Mapping[Any, Any]) -> Fault | None:
    """Fault of an entry in brackets without a colon, or without a blank behind it: all of it is read as a key."""
    match = re.match(r"(\w+)(\s*:\s*|\s+)[^\s=:]", str(key))
    if not match or match[1] not in known or match[1] in raw:
        return None
    keys = list(raw)
    if ":" not in match[2] and keys.index(key) and keys[keys.index(key) - 1] in ("description", "source", "name"):
        return None  # rather a comma in that text
    lacks = f'a blank is missing after "{match[1]}:"' if ":" in match[2] else f'a colon is missing after "{match[1]}"'
    text = f"{lacks}; write {match[1]}: {str(key)[match.end() - 1 :]}"
    apart = Remedy(SEPARATE)
    return Fault(text, (key,), on_key=True, kind="unknown-entry", about=str(key), meant=match[1], remedy=apart)


FOLDER: ContextVar[Path | None] = ContextVar("folder of the file that is being read", default=None)
"""Folder of the model file that is being read, None where a text without a folder is read."""
_SUFFIXED = re.compile(r"\.[A-Za-z]\w{0,4}$")


@contextmanager
def files_beside(folder: Path | None) -> Iterator[None]:
    """Context manager within which file names are looked up in ``folder``; with None no file can be named."""
    before = FOLDER.set(folder)
    try:
        yield
    finally:
        FOLDER.reset(before)


def names_a_file(raw: object) -> bool:
    """Whether the name of a file occurs anywhere in the data as written."""
    if isinstance(raw, Mapping):
        return any(names_a_file(part) for part in raw.values())
    if isinstance(raw, list | tuple):
        return any(names_a_file(part) for part in raw)
    return isinstance(raw, Path) or (isinstance(raw, str) and _SUFFIXED.search(raw) is not None)
