"""Quick fixes of faults in a model text that is sound YAML: edits after which a fault is gone and no other has come."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

from torsionnet.core.entries.composite import Named
from torsionnet.core.errors import Fault, ModelError, UsageError
from torsionnet.model.definition import Definition
from torsionnet.model.files.located_yaml import LocatedDocument, compose
from torsionnet.model.files.value_editing import node_at
from torsionnet.text.entry_edits import WrittenText
from torsionnet.text.example_values import example_values
from torsionnet.text.text_edits import TextEdit, TextFix, TextSpan, edited

_MEANT = re.compile(r'did you mean "?([^"?]+)"?\?')
_QUOTED = re.compile(r'"([^"]*)"')
_GOT = re.compile(r"got '([^']*)'")
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_TO_WRITE = re.compile(r"write (?:the ratio as a number \()?([^;)]+)")
_UNIT = re.compile(r'^"([^"]*)" (?:is not a value of .*expected a unit such as|has the dimension of .* is in) ([^ ;]+)')
_FRAGMENT_OF_TEXT = ("description", "source", "name")
_SECTIONS_OF_NAMES = ("elements", "parameters", "inputs", "sensors", "excitations", "use", "parts", "scenarios")


@dataclass(frozen=True)
class FaultPlace:
    """Fault of a model text with its stretch, as the rules of fixes look at it."""

    fault: Fault
    span: TextSpan
    written: WrittenText

    @property
    def shown(self) -> str:
        """Text that the fault marks."""
        return self.written.text[self.span.start : self.span.end]

    @cached_property
    def value_span(self) -> TextSpan | None:
        """Stretch of the value at the path of the fault, None where there is none."""
        node = node_at(self.written.document, self.fault.path)
        return self.written.value_span(node) if node is not None and self.fault.path else None

    def fix(self, title: str, *edits: TextEdit) -> Iterator[TextFix]:
        """Fix by some edits, if reading the changed entry finds nothing new."""
        if edits and self._mends(edits):
            yield TextFix(title, edits)

    def written_as(self, span: TextSpan, new: str) -> Iterator[TextFix]:
        """Fix that writes another value, in the quotes of the one there."""
        old = self.written.text[span.start : span.end]
        if old[:1] in ("'", '"') and old[:1] == old[-1:] and not new.startswith(old[0]):
            new = f"{old[0]}{new}{old[0]}"
        elif self.written.is_json and not _NUMBER.fullmatch(new) and new not in ("true", "false"):
            new = self.written.written(new)
        yield from self.fix(f"write {new}", TextEdit(span, new))

    def without(self, *paths: tuple[str | int, ...]) -> Iterator[TextFix]:
        """Fixes that delete entries, one for each path."""
        for path in paths:
            if node_at(self.written.document, path) is not None and path:
                yield from self.fix(f'delete "{path[-1]}"', *self.written.removal(path))

    def _mends(self, edits: tuple[TextEdit, ...]) -> bool:
        try:
            document = compose(
                edited(self.written.text, edits).removeprefix("\ufeff"), self.written.document.file
            )
        except (ModelError, ValueError):
            return False
        before, after = self._faults_read, _section_faults(document, self.fault)
        return after <= before and (after < before or self.fault.message not in before)

    @cached_property
    def _faults_read(self) -> set[str]:
        return _section_faults(self.written.document, self.fault)


def _section_faults(document: LocatedDocument, fault: Fault) -> set[str]:
    """Messages of the faults in reading the section of a fault, or the one entry of it that it is about."""
    data = document.data
    section = fault.path[0] if fault.path else ""
    specs = dict(Definition.specs())
    found = {one.message for one in document.faults}
    if isinstance(data, dict) and (section not in specs or section not in data):
        return found | {one.message for one in Definition.key_faults(data)}
    if not isinstance(data, dict):
        return found
    raw, spec = data[section], specs[str(section)]
    if isinstance(spec, Named) and isinstance(raw, dict) and len(fault.path) > 1:
        name = fault.path[1]
        raw = {name: raw[name]} if name in raw else {}
        if not raw:
            return found
    return found | {one.message for one in spec.read(raw)[1]}


Rule = Callable[[FaultPlace], Iterable[TextFix]]


def quick_fixes(fault: Fault, span: TextSpan, written: WrittenText) -> tuple[TextFix, ...]:
    """Fixes of a fault in a text that is sound YAML, the likeliest first; none where nobody can know what was meant."""
    place = FaultPlace(fault, span, written)
    found: dict[tuple[TextEdit, ...], TextFix] = {}
    for rule in _RULES:
        try:
            for fix in rule(place):
                found.setdefault(fix.edits, fix)
        except UsageError:  # the text has no such entry, as where a part or another file has it
            continue
    return tuple(found.values())


def _words(word: str, text: str, start: int, new: str) -> Iterator[TextEdit]:
    """Edits that replace a word where it stands alone."""
    for one in re.finditer(rf"(?<![\w.]){re.escape(word)}(?![\w])", text):
        yield TextEdit(TextSpan(start + one.start(), start + one.end()), new)


def _name_meant(place: FaultPlace) -> Iterator[TextFix]:
    """Another word where the message asks whether that was meant."""
    fault, text = place.fault, place.written.text
    found = _MEANT.search(fault.message)
    meant = fault.meant or (found[1] if found else "")
    if not meant or ": " in meant or _NUMBER.match(meant):
        return
    siblings = node_at(place.written.document, fault.path[:-1])
    if fault.on_key and siblings is not None and meant in siblings.entries and fault.kind == "unknown key":
        yield from place.without(fault.path)
        return
    quoted, got = _QUOTED.search(fault.message), _GOT.search(fault.message)
    wrong = [fault.about, quoted[1] if quoted else "", got[1] if got else "", fault.message.partition(" ")[0]]
    spans = [place.span, *([place.value_span] if place.value_span else [])]
    for word in wrong:
        for span in spans:
            edits = tuple(_words(word, text[span.start : span.end], span.start, meant)) if word else ()
            if edits and word != meant:
                yield from place.fix(f'write "{meant}"', *edits)
                return


def _number_meant(place: FaultPlace) -> Iterator[TextFix]:
    """Another number where the message asks whether that was meant."""
    found = _MEANT.search(place.fault.message)
    if found and _NUMBER.match(found[1]) and _NUMBER.match(place.shown.strip("'\"")):
        yield from place.written_as(place.span, found[1])


def _product(place: FaultPlace) -> Iterator[TextFix]:
    """A sign of multiplication before a parameter that was read as a unit."""
    found = re.search(r'"([^"]*)" is not a known unit', place.fault.message)
    if not found or place.value_span is None:
        return
    name, text = found[1], place.written.text[place.value_span.start : place.value_span.end]
    known = node_at(place.written.document, ("parameters",))
    factor = re.search(rf"(\d)\s+{re.escape(name)}(?!\w)", text)
    if factor and known is not None and name in known.entries:
        start = place.value_span.start + factor.end(1)
        yield from place.fix(f"write {factor[1]}*{name}", TextEdit(TextSpan(start, start + factor.end() - factor.end(1)), f"*{name}"))


def _point_for_comma(place: FaultPlace) -> Iterator[TextFix]:
    """A decimal point, also where a comma in brackets split the number."""
    if "has a decimal comma" not in place.fault.message:
        return
    start, text = place.span.start, place.written.text
    found = re.search(r"(\d),(\d)", place.shown)
    before = re.search(r"\d(\s*,\s*)$", text[:start])
    if found:
        comma = start + found.end(1)
        yield from place.fix("write a decimal point", TextEdit(TextSpan(comma, comma + 1), "."))
    elif before:
        yield from place.fix("write a decimal point", TextEdit(TextSpan(before.start(1), start), "."))


def _as_said(place: FaultPlace) -> Iterator[TextFix]:
    """What the message says one should write."""
    message = place.fault.message
    found, quoted = _TO_WRITE.search(message), _QUOTED.search(message)
    if not found or not quoted or "decimal comma" in message or "it is a parameter" in message or '"' in found[1]:
        return
    span = place.span
    if "thousands separators" in message:  # the message gives the number without its unit
        digits = re.match(r"[-+\d_' .,]*\d", quoted[1])
        start = place.written.text.find(digits[0], span.start, span.end) if digits else -1
        if digits and start >= 0:
            span = TextSpan(start, start + len(digits[0]))
            yield from place.fix(f"write {found[1]}", TextEdit(span, found[1]))
        return
    if place.shown.strip("'\"") == quoted[1]:
        yield from place.written_as(span, found[1].strip())


def _without_zeros(place: FaultPlace) -> Iterator[TextFix]:
    if "leave the 0 out" in place.fault.message:
        zeros = re.match(r"(['\"]?[-+]?)(0+)(?=\d)", place.shown)
        if zeros:
            start = place.span.start
            span = TextSpan(start + zeros.start(2), start + zeros.end(2))
            yield from place.fix("leave the 0 out", TextEdit(span, ""))


def _unit(place: FaultPlace) -> Iterator[TextFix]:
    """The unit that the message expects, with the number as it is; Hz of a speed become revolutions per minute."""
    found = _UNIT.match(place.fault.message)
    number = _NUMBER.match(found[1]) if found else None
    if not found or number is None or place.shown.strip("'\"") != found[1]:
        return
    if "Hz counts cycles" in place.fault.message and found[1][number.end() :].strip() == "Hz":
        yield from place.written_as(place.span, f"{60 * float(number[0]):g} rpm")
    yield from place.written_as(place.span, f"{number[0]} {found[2]}")


def _missing(place: FaultPlace) -> Iterator[TextFix]:
    """An entry that is missing, with an example of its value."""
    fault, written = place.fault, place.written
    if fault.kind != "missing key" or not fault.about:
        return
    root = written.node(())
    if fault.about == "torsionnet" and not written.is_flow(root):
        start = written.start(root)
        yield TextFix("insert torsionnet: 1", (TextEdit(TextSpan(start, start), f"torsionnet: 1{written.line_break}"),))
        return
    if fault.about == "torsionnet":
        first = written.key_start(next(iter(root.entries.values())))
        text = f"{written.entry_text('torsionnet', 1)}, "
        yield TextFix("insert torsionnet: 1", (TextEdit(TextSpan(first, first), text),))
        return
    for value in example_values(written.document, fault.path, fault.about):
        fixes = list(
            place.fix(
                f"insert {written.entry_text(fault.about, value)}", written.insertion(fault.path, fault.about, value)
            )
        )
        if fixes:
            yield from fixes
            return


def _without_value(place: FaultPlace) -> Iterator[TextFix]:
    """A value for an entry that has none, or the entry left out."""
    found = re.match(r"(\w+) has no value", place.fault.message)
    if not found or place.value_span is None:
        return
    yield from place.without(place.fault.path)
    for value in example_values(place.written.document, place.fault.path[:-1], found[1]):
        edit = place.written.replacement(place.fault.path, value)
        fixes = list(place.fix(f"write {place.written.entry_text(found[1], value)}", edit))
        if fixes:
            yield from fixes
            return


def _given_twice(place: FaultPlace) -> Iterator[TextFix]:
    """Another name for the second of two entries with one name, or one of both left out."""
    fault, text = place.fault, place.written.text
    if " was already given at " not in fault.message or not fault.path:
        return
    name, span = str(fault.path[-1]), place.span
    siblings = place.written.node(fault.path[:-1]).entries
    number = next(number for number in range(2, 1000) if f"{name}_{number}" not in siblings)
    new = f'"{name}_{number}"' if text[span.start : span.end].startswith('"') else f"{name}_{number}"
    second = edited(text, [TextEdit(span, new)])
    if len(fault.path) == 2 and fault.path[0] in _SECTIONS_OF_NAMES:
        yield from place.fix(f"rename to {new}", TextEdit(span, new))
    try:
        document = compose(second.removeprefix("\ufeff"), place.written.document.file)
    except ModelError:
        return
    grown = WrittenText(second, document, place.written.is_json)
    more = len(new) - (span.end - span.start)
    for edit in grown.removal((*fault.path[:-1], f"{name}_{number}")):
        end = edit.span.end - more if edit.span.start <= span.start < edit.span.end else edit.span.end
        yield from place.fix(f'delete this "{name}"', TextEdit(TextSpan(edit.span.start, end), edit.text))


def _unused(place: FaultPlace) -> Iterator[TextFix]:
    if re.fullmatch(r'parameter "[^"]*" is not used', place.fault.message):
        yield from place.without(place.fault.path)


def _text_with_comma(place: FaultPlace) -> Iterator[TextFix]:
    """Quotes around a text whose comma split it."""
    fault, written = place.fault, place.written
    node = node_at(written.document, fault.path)
    if "text with a comma needs quotes" not in fault.message or node is None or node.value is not None:
        return
    siblings = written.node(fault.path[:-1]).entries
    keys = list(siblings)
    before = keys[keys.index(fault.path[-1]) - 1]
    if before in _FRAGMENT_OF_TEXT and isinstance(siblings[before].value, str):
        span = TextSpan(written.start(siblings[before]), place.span.end)
        text = written.text[span.start : span.end]
        if '"' not in text and "\\" not in text:
            yield from place.fix("put the text in quotes", TextEdit(span, f'"{text}"'))


def _other_form(place: FaultPlace) -> Iterator[TextFix]:
    """A value in the form that the message expects: true or false, text, a list, the number of the format."""
    message, shown, span = place.fault.message, place.shown, place.span
    word = shown.strip("'\"").lower()
    if message.startswith("expected true or false") and word in ("yes", "on", "y", "no", "off", "n"):
        yield from place.fix("write true" if word in ("yes", "on", "y") else "write false", TextEdit(span, "true" if word in ("yes", "on", "y") else "false"))
    if message.startswith("expected text, got") and shown and '"' not in shown and place.value_span == span:
        yield from place.fix("put it in quotes", TextEdit(span, f'"{shown}"'))
    if re.match("expected a list of .*got '", message) and place.value_span == span:
        yield from place.fix("make it a list", TextEdit(span, f"[{shown}]"))
    if message.startswith("torsionnet: is the version of the format, 1") and word in ("1", "1.0"):
        yield from place.fix("write 1", TextEdit(span, "1"))


def _left_out(place: FaultPlace) -> Iterator[TextFix]:
    """An entry left out that contradicts another."""
    path, message = place.fault.path, place.fault.message
    both = re.match(r"give (\w+) or (\w+), not both", message)
    if both:
        yield from place.without(*((*path[:-1], key) for key in both.groups()))
    one = re.search(r"leave out (\w+)", message)
    if one and path and path[-1] == one[1]:
        yield from place.without(path)


def _valid_name(place: FaultPlace) -> Iterator[TextFix]:
    """A name of letters, digits and _ in all places that have it."""
    found = re.match(r'"([^"]*)" is not a valid name; use letters', place.fault.message)
    name = found[1] if found else ""
    new = re.sub(r"[^A-Za-z0-9_]+", "_", name).strip("_")
    if not re.match("[A-Za-z]", new) or re.search(rf"(?<!\w){re.escape(new)}(?!\w)", place.written.text):
        return
    edits = tuple(_words(name, place.written.text, 0, new))
    yield from place.fix(f"write {new}", *edits)


_RULES: tuple[Rule, ...] = (
    _name_meant,
    _product,
    _number_meant,
    _point_for_comma,
    _as_said,
    _without_zeros,
    _unit,
    _missing,
    _without_value,
    _given_twice,
    _text_with_comma,
    _other_form,
    _left_out,
    _valid_name,
    _unused,
)
