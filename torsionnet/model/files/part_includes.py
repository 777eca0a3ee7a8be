"""Inclusion of parts from other files, those that a model includes and those of the library that it names."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from torsionnet.base.entries.declared import KEY, files_beside
from torsionnet.base.entries.spec import EntryError
from torsionnet.base.errors import EntryPath, Fault, ModelError
from torsionnet.base.nearby_files import nearby_bytes, nearby_file
from torsionnet.model.files.library import decode, library_parts
from torsionnet.model.files.located_yaml import LocatedDocument, LocatedNode, compose

_FILE_OF_PARTS = (KEY, "name", "source", "description", "parts", "include")
"""Keys that a file of parts may have."""
_OF_THE_WHOLE = (KEY, "name", "operating_point", "speeds", "load", "scenarios", "bench", "report", "parts", "include")
"""Keys of a model that describe it as a whole and are left out where the model is used as a part."""
MOST_INCLUDED = 200
"""Largest number of files that one file includes; each is looked for on disk whenever the text is read."""


def include_parts(document: LocatedDocument) -> None:
    """Put the parts that a model uses from other files into its data, each with its own file position."""
    root = document.root
    if root is None or not {"include", "use", "parts"} & root.entries.keys():
        return
    reading = _Including(document)
    reading.own_parts(document)
    reading.included(document, ())
    wanted = reading.used(root)
    parts: dict[str | int, LocatedNode] = {
        name: node for name, node in reading.parts.items() if name in wanted or node.home is None
    }
    entries = {key: node for key, node in root.entries.items() if key != "include"}
    own = root.entries.get("parts", LocatedNode({}, root.place, {}))
    if isinstance(own.value, dict) and (parts or own.value):
        value = own.value | {name: node.value for name, node in parts.items()}
        entries["parts"] = replace(own, value=value, entries={**own.entries, **parts})
    document.root = replace(root, value={key: node.value for key, node in entries.items()}, entries=entries)


class _Including:
    """Table of all parts that a model can name, filled from the files that it includes.

    Those of the document itself have no home of their own.
    """

    def __init__(self, document: LocatedDocument) -> None:
        self.document = document
        self.parts: dict[str, LocatedNode] = {}
        self.places: dict[str, str] = {}
        self.read: set[Path] = set()

    def own_parts(self, document: LocatedDocument) -> None:
        node = document.root.entries.get("parts") if document.root else None
        for name, part in node.entries.items() if node else ():
            home = None if document is self.document else document
            self.add(str(name), replace(part, home=home), document, ("parts", str(name)))

    def add(self, name: str, part: LocatedNode, document: LocatedDocument, path: EntryPath) -> None:
        if name in self.parts:
            text = f'two parts are named "{name}"; the other one is at {self.places[name]}'
            self.refuse(Fault(text, path, on_key=True, kind="repeated-name"), document)
            return
        position = document.position(path, on_key=True)
        self.parts[name], self.places[name] = part, f"{position.file}:{position.line}"

    def refuse(self, fault: Fault, document: LocatedDocument) -> None:
        position = document.position(fault.path, on_key=fault.on_key)
        # The path is one of another file unless it is the document's own.
        path = fault.path if document is self.document else ()
        self.document.faults.append(replace(fault, path=path, position=position))

    def included(self, document: LocatedDocument, within: tuple[Path, ...]) -> None:
        """Read the parts of the files that a document includes, and of those that they include."""
        node = document.root.entries.get("include") if document.root else None
        if node is None:
            return
        if not isinstance(node.value, list):
            self.refuse(Fault("include is a list of files: [throws.yaml]", ("include",), kind="wrong-form"), document)
            return
        if len(node.value) > MOST_INCLUDED:
            text = f"{len(node.value)} files are included, at most {MOST_INCLUDED} can be; put several parts into one"
            self.refuse(Fault(text, ("include",), on_key=True, kind="too-large"), document)
            return
        for index, name in enumerate(node.value):
            try:
                self.file(str(name), within)
            except EntryError as error:
                self.refuse(replace(error.fault, path=("include", index)), document)
            except ModelError as error:
                self.document.faults += error.faults

    def file(self, name: str, within: tuple[Path, ...]) -> None:
        path = nearby_file(name)
        home = path.resolve()
        if home in within or home == Path(self.document.file).resolve():
            raise EntryError(
                f'"{name}" includes itself, directly or by way of others; leave it out', kind="circular-definition"
            )
        if home in self.read:
            return
        self.read.add(home)
        document = compose(decode(nearby_bytes(path), str(path)).removeprefix("\ufeff"), str(path))
        self.take(document, path)
        with files_beside(path.parent):
            self.included(document, (*within, home))

    def take(self, document: LocatedDocument, path: Path) -> None:
        """Add the parts in a file, or the model that it holds as one part."""
        self.document.faults += document.faults
        root = document.root
        if root is None or not isinstance(root.value, dict):
            raise EntryError(
                f'"{path.name}" holds no parts; it would have parts:, or be a model with ports:', kind="wrong-file"
            )
        self.own_parts(document)
        if "ports" in root.entries:
            entries = {key: node for key, node in root.entries.items() if key not in _OF_THE_WHOLE}
            value = {key: node.value for key, node in entries.items()}
            self.add(path.stem, replace(root, value=value, entries=entries, home=document), document, ())
        elif "elements" in root.entries or "use" in root.entries:
            raise EntryError(
                f'"{path.name}" is a model without ports; give it ports: [...], the nodes to join it at',
                kind="missing-entry",
            )
        else:
            for key in root.entries:
                if key not in _FILE_OF_PARTS:
                    text = f'a file of parts has {", ".join(_FILE_OF_PARTS)}, no "{key}"'
                    self.refuse(Fault(text, (key,), on_key=True, kind="unknown-entry"), document)

    def used(self, root: LocatedNode) -> set[str]:
        """Names of all parts that the model uses, directly or in its parts; library parts are read when first named."""
        wanted: set[str] = set()
        open_: list[LocatedNode] = [root, *(node for node in self.parts.values() if node.home is None)]
        while open_:
            for name in _named(open_.pop()):
                if name in wanted:
                    continue
                wanted.add(name)
                if name not in self.parts:
                    self.from_library(name)
                if name in self.parts:
                    open_.append(self.parts[name])
        return wanted

    def from_library(self, name: str) -> None:
        path = library_parts().get(name)
        if path is not None:
            self.take(compose(path.read_text(encoding="utf-8"), str(path)), path)


def _named(model: LocatedNode) -> Iterator[str]:
    uses = model.entries.get("use")
    for use in uses.entries.values() if uses else ():
        part = use.entries.get("part")
        if part is not None and isinstance(part.value, str):
            yield part.value
