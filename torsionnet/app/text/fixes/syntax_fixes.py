"""Quick fixes of texts that are no sound YAML: indentation, brackets, quotes, colons, characters."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

from torsionnet.app.text.text_edits import TextEdit, TextFix, TextLines, TextSpan, edited
from torsionnet.base.errors import Fault, ModelError
from torsionnet.base.packages import gc_paused
from torsionnet.model.definition import Definition
from torsionnet.model.files.located_yaml import (
    compose,
)

_COMMENT = re.compile(r"\s#")
_MOST_TRIED = 12
"""Largest number of edits of which the best is searched, as each is read."""

_PAIRS = {"}": "{", "]": "["}


@dataclass(frozen=True)
class _Break:
    """Place at which a text stops being YAML."""

    fault: Fault
    offset: int
    lines: TextLines

    @property
    def text(self) -> str:
        return self.lines.text

    @property
    def number(self) -> int:
        return self.lines.place(self.offset)[0]

    @property
    def line(self) -> str:
        return self.line_at(self.number)

    def line_at(self, number: int) -> str:
        if not 0 <= number < len(self.lines.starts):
            return ""
        return self.text[self.lines.starts[number] : self.lines.offset(number, len(self.text))]

    @property
    def start(self) -> int:
        return self.lines.starts[self.number]

    @property
    def content_end(self) -> int:
        """Offset of the end of the line without blanks and comment."""
        comment = _COMMENT.search(self.line, self.offset - self.start)
        return self.start + len((self.line[: comment.start()] if comment else self.line).rstrip())

    def inserted(self, title: str, place: int, text: str) -> TextFix:
        return TextFix(title, (TextEdit(TextSpan(place, place), text),))

    def replaced(self, title: str, start: int, end: int, text: str) -> TextFix:
        return TextFix(title, (TextEdit(TextSpan(start, end), text),))

    def deleted(self, what: str, start: int, end: int) -> TextFix:
        return replace(self.replaced(f"delete {what}", start, end, ""), hides=True)


@gc_paused()
def syntax_fixes(fault: Fault, span: TextSpan, lines: TextLines, file: str, known: int = 0) -> tuple[TextFix, ...]:
    """Fix of a text that is no sound YAML, the one after which most of it can be read; none where no fix is known.

    ``known`` is the number of other faults of the text. Quotes and deletions are only offered if they bring no others,
    as nearly every text is sound YAML after them.
    """
    here = _Break(fault, span.start, lines)
    best: tuple[int, TextFix] | None = None
    for _, fix in zip(range(_MOST_TRIED), _candidates(here), strict=False):
        left = _faults_left(edited(lines.text, fix.edits), file)
        if left is None or (left > known and fix.hides):
            continue
        if best is None or left < best[0]:
            best = left, fix
        if best[0] == 0:
            break
    return (best[1],) if best else ()


def _faults_left(text: str, file: str) -> int | None:
    """Number of faults in reading a text, None where it still is no sound YAML."""
    try:
        document = compose(text.removeprefix("\ufeff"), file)
    except ModelError:
        return None
    if not isinstance(document.data, dict):
        return 1 + len(document.faults)
    return len(document.faults) + len(Definition.read_entries(document.data)[1])


def _candidates(here: _Break) -> Iterator[TextFix]:
    for rule, kinds in _RULES:
        if here.fault.kind in kinds:
            yield from rule(here)


def _character(here: _Break) -> Iterator[TextFix]:
    yield here.deleted("this character", here.offset, here.offset + 1)


def _tabs(here: _Break) -> Iterator[TextFix]:
    if "\t" not in here.line:
        return
    edits = []
    for number, start in enumerate(here.lines.starts):
        line = here.line_at(number)
        blank = line[: len(line) - len(line.lstrip(" \t"))]
        if "\t" in blank:
            edits.append(TextEdit(TextSpan(start, start + len(blank)), blank.replace("\t", "  ")))
    yield TextFix("indent with spaces", tuple(edits))
    indent = re.match(r"[ \t]*", here.line)
    if indent:
        for width in dict.fromkeys(_indents(here)):
            yield here.replaced("indent with spaces", here.start, here.start + indent.end(), " " * width)
    yield here.replaced("write a blank for the tab", here.offset, here.offset + 1, " ")


def _indents(here: _Break) -> Iterator[int]:
    """Indentation of the lines around, nearest first."""
    for step in (-1, 1):
        number, seen = here.number + step, 0
        while 0 <= number < len(here.lines.starts) and seen < 4:
            line = here.line_at(number)
            bare = line.lstrip()
            if bare and bare[0] not in "#\t":
                yield len(line) - len(bare)
                seen += 1
            number += step


def _indentation(here: _Break) -> Iterator[TextFix]:
    old = len(here.line) - len(here.line.lstrip(" "))
    for width in sorted(dict.fromkeys(_indents(here)), key=lambda width: abs(width - old)):
        if width != old:
            yield here.replaced("indent as the lines around", here.start, here.start + old, " " * width)


def _quote(here: _Break) -> Iterator[TextFix]:
    sign = here.text[here.offset : here.offset + 1]
    if sign not in ("'", '"'):
        return
    rest = here.text[here.offset + 1 : here.content_end]
    for gap in re.finditer(r"(?=, *\w+ *:)|(?=[}\]]+ *,?$)|$", rest):
        place = here.offset + 1 + gap.start()
        yield here.inserted(f"close with {sign}", place, sign)
    yield here.deleted(sign, here.offset, here.offset + 1)


def _bracket(here: _Break) -> Iterator[TextFix]:
    began = here.fault.remedy.place if here.fault.remedy else None
    opened = here.lines.offset(*began) if began else here.offset
    if here.text[opened : opened + 1] not in ("{", "["):
        return
    close = "}" if here.text[opened] == "{" else "]"
    there = _Break(here.fault, opened, here.lines)
    end = max(there.content_end, min(here.offset, len(here.text))) if began else there.content_end
    inside = here.text[opened:end]
    # A list has no keys: what follows ", key:" is meant to stand behind it.
    if close == "]":
        for gap in re.finditer(r",\s*\w+\s*:", inside):
            yield here.inserted("close with ]", opened + gap.start(), "]")
        for gap in re.finditer(r"\s*[}]", inside):
            yield here.inserted("close with ]", opened + gap.start(), "]")
    yield here.inserted(f"close with {close}", there.content_end, close)
    for gap in re.finditer(r"(?<=[\w\]}\"'])\s+(?=\w+\s*:)", inside):
        yield here.inserted("insert a comma", opened + gap.start(), ",")
    for gap in re.finditer(r"(?<=\w)\s*(?=\{)", inside):
        yield here.replaced("write a colon before the bracket", opened + gap.start(), opened + gap.end(), ": ")
    if here.offset > opened:
        before = len(here.text[: here.offset].rstrip())
        yield here.inserted("insert a comma", before, ",")
        yield here.inserted(f"close with {close}", before, close)
    # At last the other bracket, and none: each fix is offered only if it mends the text.
    nested = "]" if close == "}" else "}"
    yield here.inserted(f"close with {nested}", there.content_end, nested)
    yield here.deleted(here.text[opened], opened, opened + 1)


def _surplus(here: _Break) -> Iterator[TextFix]:
    for place in (here.offset, here.offset - 1):
        if here.text[place : place + 1] in ("}", "]", ",") and place >= 0:
            yield here.deleted(here.text[place], place, place + 1)


def _colon(here: _Break) -> Iterator[TextFix]:
    key = re.compile(r"(\w+)\s*:?\s*").match(here.text, here.offset)
    if key:
        yield here.replaced(f'write "{key[1]}: "', here.offset, key.end(), f"{key[1]}: ")


def _missing_colon(here: _Break) -> Iterator[TextFix]:
    """A colon after a word alone on its line, here or above."""
    for number in range(here.number, here.number - 3, -1):
        line = here.line_at(number).partition(" #")[0]
        pair = re.fullmatch(r"(\s*[A-Za-z_]\w*)(\s*[=:]\s*|\s+)(\S.*)", line)
        if pair and pair[2] != ": " and 0 <= number < len(here.lines.starts):
            start = here.lines.starts[number] + pair.end(1)
            yield here.replaced(f'write "{pair[1].strip()}: "', start, start + len(pair[2]), ": ")
        word = re.fullmatch(r"(\s*\w+)\s*", here.line_at(number).partition(" #")[0])
        if word and 0 <= number < len(here.lines.starts):
            yield here.inserted("write a colon after the name", here.lines.starts[number] + word.end(1), ":")


def _quoted_value(here: _Break) -> Iterator[TextFix]:
    """Quotes around the value of the line, or around the word at which the break is."""
    key = re.match(r"\s*(- )?[^:#\s]+:\s+", here.line)
    starts = [here.start + key.end()] if key else []
    for start in dict.fromkeys(
        [here.offset, *starts] if ":" not in here.text[here.offset : here.offset + 1] else starts
    ):
        rest = here.text[start : here.content_end]
        for close in re.finditer(r"(?=[,}\]])|$", rest):
            value = rest[: close.start()].rstrip()
            if value and '"' not in value and "\\" not in value:
                fix = here.replaced("put the text in quotes", start, start + len(value), f'"{value}"')
                yield replace(fix, hides=True)


def _opening(here: _Break) -> Iterator[TextFix]:
    """The opening bracket of a value that ends with one."""
    key = re.match(r"\s*(- )?[^:#\s]+:\s+(?=\w)", here.line)
    close = here.text[here.content_end - 1 : here.content_end]
    if key and close in ("}", "]"):
        yield here.inserted(f"insert {_PAIRS[close]}", here.start + key.end(), _PAIRS[close])


def _joined(here: _Break) -> Iterator[TextFix]:
    """A line break before a section of a model that begins in the middle of a line."""
    sections = "|".join(("torsionnet", *dict(Definition.specs())))
    for gap in re.finditer(rf"(?<=[^\s{{,])[ \t]*(?=({sections}):)", here.line):
        start = here.start + gap.start()
        yield here.replaced(f"begin {gap[1]} on a line of its own", start, here.start + gap.end(), "\n")


def _behind(here: _Break) -> Iterator[TextFix]:
    """Fix that deletes what stands behind a value in brackets."""
    behind = re.search(r"(?<=[}\]])[^}\]\s,#]+$", here.text[here.start : here.content_end])
    if behind:
        start = here.start + behind.start()
        yield here.deleted(behind[0], start, start + len(behind[0]))


def _blank_for_value(here: _Break) -> Iterator[TextFix]:
    for colon in re.finditer(r"(?<=\w):(?=[}\],])", here.line):
        yield here.inserted("write a blank behind the colon", here.start + colon.end(), " ")


def _single_quotes(here: _Break) -> Iterator[TextFix]:
    for quoted in re.finditer(r'"([^"]*)"', here.line):
        if "\\" in quoted[1] and "'" not in quoted[1]:
            start = here.start + quoted.start()
            yield here.replaced("use single quotes", start, here.start + quoted.end(), f"'{quoted[1]}'")


def _tag(here: _Break) -> Iterator[TextFix]:
    tag = re.compile(r"!\S*[ \t]*").match(here.text, here.offset)
    if tag:
        yield here.deleted(tag[0].strip(), here.offset, tag.end())


def _alias(here: _Break) -> Iterator[TextFix]:
    alias = re.compile(r"\*(\w+)").match(here.text, here.offset)
    if alias and re.search(rf"(?<!\w){alias[1]}\s*:", here.text):
        yield here.replaced(f"write {alias[1]}", here.offset, alias.end(), alias[1])


_RULES = (
    (_character, ("invalid-character",)),
    (_tabs, ("wrong-indentation",)),
    (_indentation, ("wrong-indentation",)),
    (_quote, ("open-quote",)),
    (_blank_for_value, ("missing-value",)),
    (_bracket, ("open-bracket", "missing-value")),
    (_colon, ("missing-colon",)),
    (_joined, ("stray-colon", "wrong-indentation")),
    (_opening, ("stray-colon", "wrong-indentation")),
    (_behind, ("stray-colon", "missing-quotes", "wrong-indentation")),
    (_missing_colon, ("missing-colon", "stray-colon", "wrong-indentation")),
    (_indentation, ("stray-colon",)),
    (_quoted_value, ("stray-colon", "missing-quotes")),
    (_surplus, ("wrong-indentation", "missing-quotes", "missing-value")),
    (_single_quotes, ("unknown-escape",)),
    (_tag, ("missing-quotes",)),
    (_alias, ("missing-quotes",)),
)
"""Kinds of breaks that a rule may mend, in the order in which the rules are tried."""
