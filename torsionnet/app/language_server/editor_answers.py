"""Open files of an editor, and the answers of services on their texts in the words of its protocol.

Open file of an editor, and whether it is a model file.

Text of an open file with the counting of an editor: lines, and units of UTF-16, UTF-8 or UTF-32 in a line. This is the
only place that converts between the two; everything else counts characters.
"""

from __future__ import annotations

import asyncio
import bisect
import re
from collections.abc import Awaitable, Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from lsprotocol.types import (
    CodeAction,
    CodeActionKind,
    CodeDescription,
    CompletionItem,
    CompletionItemKind,
    CompletionList,
    Diagnostic,
    DiagnosticRelatedInformation,
    DiagnosticSeverity,
    DocumentHighlight,
    DocumentHighlightKind,
    DocumentSymbol,
    InsertTextMode,
    Location,
    MarkupContent,
    MarkupKind,
    Position,
    PositionEncodingKind,
    Range,
    SymbolKind,
    WorkspaceEdit,
)
from lsprotocol.types import Hover as EditorHover
from lsprotocol.types import Position as EditorPosition
from lsprotocol.types import Range as EditorRange
from lsprotocol.types import TextEdit as EditorEdit

from torsionnet.app.text.layout import OutlineItem, formatted, hover, outline
from torsionnet.app.text.named_places import definition, named_places, references, renamable, rename
from torsionnet.app.text.text_edits import TextEdit, TextLines, TextSpan
from torsionnet.app.text.text_faults import LocatedFault, fault_link, position_span, text_faults
from torsionnet.base import errors

if TYPE_CHECKING:
    from torsionnet.app.text.completion import Completion


# Open file of an editor, and whether it is a model file.

# Text of an open file with the counting of an editor: lines, and units of UTF-16, UTF-8 or UTF-32 in a line.

_BREAK = re.compile("\r\n|\n|\r")
"""Expression of a line break of the protocol, which knows fewer of them than YAML and Python do."""


@dataclass(frozen=True)
class EditorText:
    """Text with conversion of its offsets to positions of an editor, and back.

    Examples
    --------
    >>> text = EditorText("k: 3 # \\U0001d70f\\nd: 4")
    >>> text.position(8), text.offset(Position(0, 9)), text.offset(Position(1, 0))
    (0:9, 8, 9)
    """

    text: str
    encoding: str = PositionEncodingKind.Utf16.value

    @cached_property
    def _starts(self) -> list[int]:
        """Offsets of the first character of each line."""
        return [0, *(line_break.end() for line_break in _BREAK.finditer(self.text))]

    @cached_property
    def _one_each(self) -> bool:
        """Whether every character is one unit."""
        return self.encoding == PositionEncodingKind.Utf32.value or self.text.isascii()

    def _units(self, text: str) -> int:
        if self._one_each:
            return len(text)
        if self.encoding == PositionEncodingKind.Utf8.value:
            return len(text.encode("utf-8", "surrogatepass"))
        return len(text) + sum(char > "\uffff" for char in text)

    def offset(self, position: Position) -> int:
        """Offset in characters of a position, at most that of the end of its line or of the text."""
        if position.line >= len(self._starts):
            return len(self.text)
        start = self._starts[position.line]
        line = self._line(position.line)
        if self._one_each:
            return start + min(position.character, len(line))
        units = 0
        for index, char in enumerate(line):
            if units >= position.character:
                return start + index
            units += self._units(char)
        return start + len(line)

    def _line(self, number: int) -> str:
        last = number + 1 == len(self._starts)
        return self.text[self._starts[number] : None if last else self._starts[number + 1]].rstrip("\r\n")

    def position(self, offset: int) -> Position:
        """Position of the character with an offset."""
        offset = min(max(offset, 0), len(self.text))
        line = bisect.bisect_right(self._starts, offset) - 1
        return Position(line, self._units(self.text[self._starts[line] : offset]))

    def range(self, span: TextSpan) -> Range:
        """Range in the editor of a stretch of the text."""
        return Range(self.position(span.start), self.position(span.end))

    def span(self, shown: Range) -> TextSpan:
        """Stretch of the text of a range in the editor."""
        start, end = sorted((self.offset(shown.start), self.offset(shown.end)))
        return TextSpan(start, end)

    def edits(self, edits: Iterable[TextEdit]) -> list[EditorEdit]:
        """Edits as the editor takes them."""
        return [EditorEdit(self.range(edit.span), edit.text) for edit in edits]


_KEY = re.compile(r"""^["']?torsionnet["']?[ \t]*:""", re.MULTILINE)
_KEY_IN_BRACES = re.compile(r"""[{,\s]["']?torsionnet["']?\s*:""")
_OTHERS = re.compile(r"""^["']?(vary|model)["']?[ \t]*:""", re.MULTILINE)
"""Expression of the keys of studies, benches, fits and campaigns, which name a model instead of being one."""
_OWN_NAME = re.compile(r"\.torsionnet\.(yaml|yml|json)$", re.IGNORECASE)
_OF_MODELS = re.compile(r"""^["']?(elements|use|parts|ports)["']?[ \t]*:""", re.MULTILINE)

_PARTS = re.compile(r"""^["']?parts["']?[ \t]*:""", re.MULTILINE)
_NO_PARTS = re.compile(r"""^["']?(elements|use|ports)["']?[ \t]*:""", re.MULTILINE)


@dataclass(frozen=True)
class OpenModel:
    """Model file that is open in an editor, with the text as shown there, saved or not."""

    uri: str
    shown: EditorText
    file: str
    folder: Path | None
    addresses: Mapping[Path, str] = field(default_factory=dict, compare=False)
    """Addresses of all files that are open, by their resolved paths."""

    @property
    def text(self) -> str:
        """Text of the file."""
        return self.shown.text


def is_model_text(text: str, file: str) -> bool:
    """Whether a text is that of a model file: it has the key ``torsionnet``, or the file has the ending of models.

    Studies, fits, benches and campaigns have the key too, and are no models.

    >>> is_model_text("torsionnet: 1\\nelements: {}", "plant.yaml"), is_model_text("services: {}", "compose.yaml")
    (True, False)
    >>> is_model_text("torsionnet: 1\\nmodel: amt_rig\\nvary: {}", "study.yaml")
    False
    """
    if _OWN_NAME.search(file):
        return True
    start = text.removeprefix("\ufeff").lstrip()
    if start.startswith("{"):
        return _KEY_IN_BRACES.search(start) is not None
    return _KEY.search(text.removeprefix("\ufeff")) is not None and not names_a_model(text)


def names_a_model(text: str) -> bool:
    """Whether a text is that of a study, fit, bench or campaign, which name a model instead of being one."""
    return _OTHERS.search(text) is not None and _OF_MODELS.search(text) is None


def is_parts_text(text: str) -> bool:
    r"""Whether a text is that of a file of parts, which models include, and which is no model itself.

    >>> is_parts_text("torsionnet: 1\nparts: {}"), is_parts_text("torsionnet: 1\nparts: {}\nelements: {}")
    (True, False)
    """
    return _PARTS.search(text) is not None and _NO_PARTS.search(text) is None


# Schedule of checks: the newest text of a file wins, and nothing waits for a long check.

CHANGE_DELAY = 0.1
"""Time in s without a further change after which a changed text is checked, as nobody reads while typing."""


class CheckSchedule:
    """Tasks that check open files, at most one of each file; a newer one takes the place of the one before."""

    def __init__(self, check: Callable[[str], Awaitable[None]]) -> None:
        self._check = check
        self._tasks: dict[str, asyncio.Task[None]] = {}

    def ask(self, uri: str, delay: float = 0.0) -> None:
        """Check a file after a delay in s, unless it is asked for again before."""
        self.drop(uri)
        task = asyncio.get_running_loop().create_task(self._later(uri, delay))
        self._tasks[uri] = task
        task.add_done_callback(lambda done: self._forget(uri, done))

    def drop(self, uri: str) -> None:
        """Give up the check of a file that is no longer wanted; what it finds is not shown."""
        task = self._tasks.pop(uri, None)
        if task is not None:
            task.cancel()

    async def _later(self, uri: str, delay: float) -> None:
        await asyncio.sleep(delay)
        await self._check(uri)

    def _forget(self, uri: str, task: asyncio.Task[None]) -> None:
        if self._tasks.get(uri) is task:
            del self._tasks[uri]


# Answers of the services on texts in the words of the Language Server Protocol.

_COMPLETIONS = {
    "entry": CompletionItemKind.Property,
    "element type": CompletionItemKind.Class,
    "node": CompletionItemKind.Variable,
    "parameter": CompletionItemKind.Constant,
    "unit": CompletionItemKind.Unit,
    "size": CompletionItemKind.Value,
    "configuration": CompletionItemKind.EnumMember,
    "sensor": CompletionItemKind.Event,
    "part": CompletionItemKind.Module,
    "word": CompletionItemKind.Enum,
}
"""Symbols that editors show beside a proposal, by its kind."""

_SYMBOLS = {
    "section": SymbolKind.Namespace,
    "element": SymbolKind.Object,
    "parameter": SymbolKind.Constant,
    "node": SymbolKind.Variable,
    "part": SymbolKind.Class,
    "configuration": SymbolKind.Enum,
    "sensor": SymbolKind.Event,
}
"""Symbols that editors show in an outline, by the kind of an item."""


def completion_list(model: OpenModel, at: EditorPosition) -> CompletionList:
    """Proposals for what is written at a position, in the order of the service."""
    from torsionnet.app.text.completion import completions

    offset = model.shown.offset(at)
    proposals = completions(model.text, offset, model.file, model.folder)
    items = [_completion(model, proposal, number) for number, proposal in enumerate(proposals)]
    # Before a word has begun, the next key asks anew: left to themselves, editors match the digits 14 with k_14.
    return CompletionList(not model.text[:offset][-1:].isalnum(), items)


def _completion(model: OpenModel, proposal: Completion, number: int) -> CompletionItem:
    written = model.text[proposal.span.start : proposal.span.end]
    return CompletionItem(
        label=proposal.label,
        kind=_COMPLETIONS.get(proposal.kind, CompletionItemKind.Text),
        detail=proposal.detail or None,
        documentation=MarkupContent(MarkupKind.Markdown, proposal.documentation) if proposal.documentation else None,
        sort_text=f"{number:05d}",
        # Editors drop proposals that do not match what is written; the service has chosen already.
        filter_text=proposal.label if proposal.label.startswith(written) or not written else written,
        insert_text_mode=InsertTextMode.AsIs,  # lines after the first have their indentation
        text_edit=EditorEdit(model.shown.range(proposal.span), proposal.insert),
    )


def hover_text(model: OpenModel, at: EditorPosition) -> EditorHover | None:
    """Explanation of what stands at a position, None where nothing is to be said."""
    explanation = hover(model.text, model.shown.offset(at), model.file, model.folder)
    if explanation is None:
        return None
    return EditorHover(MarkupContent(MarkupKind.Markdown, explanation.markdown), model.shown.range(explanation.span))


def definition_location(model: OpenModel, at: EditorPosition) -> Location | None:
    """Location of the definition of the name at a position, None where there is none."""
    span = definition(model.text, model.shown.offset(at), model.file, model.folder)
    return None if span is None else Location(model.uri, model.shown.range(span))


def reference_locations(model: OpenModel, at: EditorPosition, *, with_definition: bool) -> list[Location]:
    """Locations where the name at a position stands."""
    offset = model.shown.offset(at)
    spans = references(model.text, offset, model.file, model.folder)
    if not with_definition:
        own = definition(model.text, offset, model.file, model.folder)
        spans = [span for span in spans if span != own]
    return [Location(model.uri, model.shown.range(span)) for span in spans]


def highlights(model: OpenModel, at: EditorPosition) -> list[DocumentHighlight]:
    """Stretches where the name at a position stands; what defines it is marked as written."""
    spans = references(model.text, model.shown.offset(at), model.file, model.folder)
    defining = {place.span for place in named_places(model.text, model.file, model.folder) if place.is_definition}
    return [
        DocumentHighlight(
            model.shown.range(span), DocumentHighlightKind.Write if span in defining else DocumentHighlightKind.Read
        )
        for span in spans
    ]


def renamable_range(model: OpenModel, at: EditorPosition) -> EditorRange | None:
    """Range of the name at a position that can be changed, None where there is none."""
    span = renamable(model.text, model.shown.offset(at), model.file, model.folder)
    return None if span is None else model.shown.range(span)


def renaming(model: OpenModel, at: EditorPosition, new: str) -> WorkspaceEdit:
    """Edits that change the name at a position everywhere in the file.

    Raises
    ------
    UsageError
        The name is taken or no name, or nothing there has a name to change.
    """
    edits = rename(model.text, model.shown.offset(at), new, model.file, model.folder)
    return WorkspaceEdit(changes={model.uri: model.shown.edits(edits)})


def document_symbols(model: OpenModel) -> list[DocumentSymbol]:
    """Outline of the file: sections, elements and what they hold."""
    return _symbols(model, outline(model.text, model.file))


def _symbols(model: OpenModel, items: Iterable[OutlineItem]) -> list[DocumentSymbol]:
    return [
        DocumentSymbol(
            name=item.name or "-",  # editors refuse the whole outline for one empty name
            detail=item.detail or None,
            kind=_SYMBOLS.get(item.kind, SymbolKind.Field),
            range=model.shown.range(_around(item.span, item.name_span)),
            selection_range=model.shown.range(item.name_span),
            children=_symbols(model, item.children),
        )
        for item in items
    ]


def _around(span: TextSpan, name: TextSpan) -> TextSpan:
    """Stretch of an item with its name, as editors ask for."""
    return TextSpan(min(span.start, name.start), max(span.end, name.end))


def formatting_edits(model: OpenModel, within: EditorRange | None = None) -> list[EditorEdit]:
    """Edits that lay out the file, or those of them that lie in a range."""
    edits = formatted(model.text)
    if within is not None:
        wanted = model.shown.span(within)
        edits = [edit for edit in edits if wanted.start <= edit.span.start and edit.span.end <= wanted.end]
    return model.shown.edits(edits)


# Faults of a model as diagnostics of an editor, and what mends them as code actions.

SOURCE = "torsionnet"
SEVERITIES = {
    "error": DiagnosticSeverity.Error,
    "warning": DiagnosticSeverity.Warning,
    "note": DiagnosticSeverity.Information,
}
"""Severities of diagnostics by those of faults."""


def faults_in_editor(model: OpenModel) -> list[LocatedFault]:
    """Faults of an open model that an editor shows.

    A file of parts lacks nothing when it has no elements, and its parts are used in other files.
    """
    faults = text_faults(model.text, model.file, model.folder)
    return [fault for fault in faults if not _asks_for_a_model(fault.fault)] if is_parts_text(model.text) else faults


def _asks_for_a_model(fault: errors.Fault) -> bool:
    if fault.kind == "missing-entry":
        return not fault.path
    return fault.severity == "warning" and len(fault.path) == 2 and fault.path[0] == "parts"


def diagnostics(model: OpenModel, faults: Iterable[LocatedFault]) -> list[Diagnostic]:
    """Diagnostics of the faults of an open model, with the places where an entry is used and defined."""
    return [_diagnostic(model, fault) for fault in faults]


def _diagnostic(model: OpenModel, located: LocatedFault) -> Diagnostic:
    fault = located.fault
    others = [(place, "used here") for place in fault.used_at if place != fault.position]
    others += [(fault.defined_at, "defined here")] if fault.defined_at else []
    return Diagnostic(
        range=model.shown.range(located.span),
        message=fault.text,
        severity=SEVERITIES[fault.severity],
        source=SOURCE,
        code=fault.kind or None,
        code_description=CodeDescription(fault_link(fault.kind)) if fault.kind else None,
        related_information=[
            DiagnosticRelatedInformation(_location(model, place), what) for place, what in others if place.file
        ]
        or None,
    )


def _location(model: OpenModel, place: errors.Position) -> Location:
    """Place of a fault in this or in an included file."""
    if place.file == model.file:
        return Location(model.uri, model.shown.range(_span(model.shown, place)))
    line = EditorText(place.source, model.shown.encoding)
    start, end = line.position(place.column - 1), line.position(place.end_column - 1)
    shown = Range(Position(place.line - 1, start.character), Position(place.line - 1, end.character))
    path = Path(place.file)
    return Location(model.addresses.get(path.resolve()) or path.absolute().as_uri(), shown)


def _span(shown: EditorText, place: errors.Position) -> TextSpan:
    return position_span(place, TextLines(shown.text))


def code_actions(model: OpenModel, faults: Sequence[LocatedFault], marked: TextSpan) -> list[CodeAction]:
    """Code actions that mend the faults touching a stretch of the text."""
    return [
        CodeAction(
            title=fix.title,
            kind=CodeActionKind.QuickFix,
            diagnostics=[_diagnostic(model, fault)],
            edit=WorkspaceEdit(changes={model.uri: model.shown.edits(fix.edits)}),
            is_preferred=len(fault.fixes) == 1,
        )
        for fault in faults
        if fault.span.start <= marked.end and marked.start <= fault.span.end
        for fix in fault.fixes
    ]
