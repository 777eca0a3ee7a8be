"""Outline of a model text for editors: its sections, and what stands in them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from torsionnet.app.text.hover import entry_under, key_words, thing_words, value_words
from torsionnet.app.text.named_places import SECTION_KINDS, NamedPlace, NamesInText, place_at
from torsionnet.app.text.text_edits import TextSpan
from torsionnet.base.entries.declared import files_beside
from torsionnet.base.errors import EntryPath
from torsionnet.model.files.located_yaml import LocatedNode


@dataclass(frozen=True)
class OutlineItem:
    """Entry of an outline, with the stretch of the whole entry and that of its name.

    ``kind`` is section, or that of what is named, as element, parameter or node.
    """

    name: str
    kind: str
    detail: str
    span: TextSpan
    name_span: TextSpan
    children: tuple[OutlineItem, ...] = ()


def outline(text: str, file: str = "") -> list[OutlineItem]:
    """Outline of a model text: its sections, what each defines, and below each element its nodes.

    Examples
    --------
    >>> text = "elements:\\n  disc: {type: inertia, node: hub, inertia: 2 kg*m^2}\\n"
    >>> (section,) = outline(text)
    >>> element = section.children[0]
    >>> section.name, element.name, element.detail, [child.name for child in element.children]
    ('elements', 'disc', 'inertia at hub', ['hub'])
    """
    names = NamesInText.of(text, file)
    if names.root is None:
        return []
    return list(_Outline(names).sections(names.root, ()))


class _Outline:
    """Outline of the entries of a document with the names in it."""

    def __init__(self, names: NamesInText) -> None:
        self.names = names
        self.nodes: dict[EntryPath, list[NamedPlace]] = {}
        for place in names.places:
            if place.kind == "node":
                for length in range(2, len(place.path)):
                    self.nodes.setdefault(place.path[:length], []).append(place)

    def sections(self, node: LocatedNode, path: EntryPath) -> Iterator[OutlineItem]:
        """Sections of a model or part."""
        for key, entry in node.entries.items():
            section = str(key)
            kind = "axis" if section == "configurations" else SECTION_KINDS.get(section, "")
            below = [self.thing(entry, (*path, key, name), thing, kind) for name, thing in entry.entries.items()]
            children = tuple(thing for thing in below if thing is not None) if kind else ()
            item = self.item(entry, section, "section", _value_text(entry.value) if not kind else "", children)
            if item is not None:
                yield item

    def thing(self, whole: LocatedNode, path: EntryPath, node: LocatedNode, kind: str) -> OutlineItem | None:
        """Entry of a section by its name, with what is in it."""
        name = str(path[-1])
        if kind == "element":
            places = self.nodes.get(path, [])
            nodes = tuple(OutlineItem(named.name, "node", "", named.span, named.span) for named in places)
            return self.item(node, name, kind, _element_words(node.value, [named.name for named in nodes]), nodes)
        if kind == "part":
            return self.item(node, name, kind, _value_text(node.value), tuple(self.sections(node, path)))
        if kind == "axis":
            return self.axis(whole, node, name)
        return self.item(node, name, kind, _value_text(node.value), ())

    def axis(self, whole: LocatedNode, node: LocatedNode, name: str) -> OutlineItem | None:
        """Axis with its alternatives, or an alternative of the only axis."""
        from torsionnet.model.configurations import has_axes

        if not has_axes(whole.value):
            return self.item(node, name, "configuration", _value_text(node.value), ())
        below = [
            self.item(alternative, str(label), "configuration", _value_text(alternative.value), ())
            for label, alternative in node.entries.items()
        ]
        return self.item(node, name, "axis", "", tuple(alternative for alternative in below if alternative is not None))

    def item(
        self, node: LocatedNode, name: str, kind: str, detail: str, children: tuple[OutlineItem, ...]
    ) -> OutlineItem | None:
        """Entry with its stretches, None for one of a list, which has no name."""
        if node.key_place is None:
            return None
        name_span = self.names.stretches.whole(node.key_place)
        start, end = self.names.stretches.span(node.key_place).start, self.names.stretches.span(node.place).end
        text = self.names.stretches.lines.text
        end = max(len(text[:end].rstrip()), name_span.end, *(child.span.end for child in children), 0)
        return OutlineItem(name, kind, detail, TextSpan(start, end), name_span, children)


def _element_words(raw: Any, nodes: list[str]) -> str:
    """Text on an element: its type and its nodes."""
    kind = str(raw.get("type", "")).replace("_", " ") if isinstance(raw, Mapping) else ""
    where = f"at {nodes[0]}" if len(nodes) == 1 else ", ".join(nodes)
    return f"{kind} {where}".strip()


def _value_text(raw: Any) -> str:
    """Text on the value of an entry: the value itself, that of a parameter, or what a sensor measures."""
    if not isinstance(raw, Mapping):
        return "" if raw is None or isinstance(raw, list) else _short(str(raw))
    if isinstance(raw.get("by"), str):
        return _short(f"by {raw['by'].replace('_', ' ')} of {raw.get('of', '')}")
    for key in ("value", "type", "rule", "part"):
        if isinstance(raw.get(key), str | int | float):
            return _short(str(raw[key]))
    if len(raw) <= 3 and all(isinstance(inner, str | int | float) for inner in raw.values()):
        return _short(", ".join(f"{key} {inner}" for key, inner in raw.items()))
    return ""


def _short(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= 60 else f"{line[:57]}..."


# Explanation of the word at a place in a model text.


@dataclass(frozen=True)
class Hover:
    """Explanation in Markdown, without HTML, of a stretch of a model text."""

    markdown: str
    span: TextSpan


def hover(text: str, offset: int, file: str = "", folder: Path | None = None) -> Hover | None:
    """Explanation of what stands at an offset of a model text, None where there is nothing to say.

    Of a name what it stands for, of a key what the entry is, of a value what it is in SI units. Catalogues lie in
    ``folder``.

    Examples
    --------
    >>> text = "parameters: {k: 2 kN*m/rad}\\nelements: {shaft: {type: spring, nodes: [a, b], stiffness: 3*k}}"
    >>> print(hover(text, text.index("3*k")).markdown)
    `stiffness`: `3*k` = 6000 N*m/rad
    <BLANKLINE>
    with `k` = 2000 N*m/rad
    """
    names = NamesInText.of(text, file)
    place = place_at(names.places, offset)
    # What a name stands for says more than the entry in which it stands.
    if place is not None:
        words = thing_words(place, names)
        if words:
            return Hover(words, place.span)
    under = entry_under(names, offset)
    if under is None:
        return None
    with files_beside(folder):
        words = key_words(under) if under.on_key else value_words(under)
    return Hover(words, under.span) if words else None
