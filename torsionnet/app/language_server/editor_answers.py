"""Answers of the services on texts in the words of the Language Server Protocol."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
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
    Range,
    SymbolKind,
    WorkspaceEdit,
)
from lsprotocol.types import Hover as EditorHover
from lsprotocol.types import Position as EditorPosition
from lsprotocol.types import Range as EditorRange
from lsprotocol.types import TextEdit as EditorEdit

from torsionnet.app.language_server.open_model import EditorText, OpenModel, is_parts_text
from torsionnet.app.text.fault_table import fault_link
from torsionnet.app.text.formatting import formatted
from torsionnet.app.text.named_places import definition, named_places, references, renamable, rename
from torsionnet.app.text.outline import OutlineItem, hover, outline
from torsionnet.app.text.text_edits import TextLines, TextSpan
from torsionnet.app.text.text_faults import LocatedFault, position_span, text_faults
from torsionnet.base import errors

if TYPE_CHECKING:
    from torsionnet.app.text.completion import Completion


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
