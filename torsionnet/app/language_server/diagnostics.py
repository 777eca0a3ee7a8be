"""Faults of a model as diagnostics of an editor, and what mends them as code actions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from lsprotocol.types import (
    CodeAction,
    CodeActionKind,
    Diagnostic,
    DiagnosticRelatedInformation,
    DiagnosticSeverity,
    Location,
    Position,
    Range,
    WorkspaceEdit,
)

from torsionnet.app.language_server.editor_text import EditorText
from torsionnet.app.language_server.open_model import OpenModel, is_parts_text
from torsionnet.app.text.text_edits import TextLines, TextSpan
from torsionnet.app.text.text_faults import LocatedFault, position_span, text_faults
from torsionnet.base import errors
from torsionnet.base.errors import MISSING_KEY

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
    found = text_faults(model.text, model.file, model.folder)
    return [one for one in found if not _asks_for_a_model(one.fault)] if is_parts_text(model.text) else found


def _asks_for_a_model(fault: errors.Fault) -> bool:
    if fault.kind == MISSING_KEY:
        return not fault.path
    return fault.severity == "warning" and len(fault.path) == 2 and fault.path[0] == "parts"


def diagnostics(model: OpenModel, faults: Iterable[LocatedFault]) -> list[Diagnostic]:
    """Diagnostics of the faults of an open model, with the places where an entry is used and defined."""
    return [_diagnostic(model, one) for one in faults]


def _diagnostic(model: OpenModel, located: LocatedFault) -> Diagnostic:
    fault = located.fault
    others = [(place, "used here") for place in fault.used_at if place != fault.position]
    others += [(fault.defined_at, "defined here")] if fault.defined_at else []
    return Diagnostic(
        range=model.shown.range(located.span),
        message=fault.text,
        severity=SEVERITIES[fault.severity],
        source=SOURCE,
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
            diagnostics=[_diagnostic(model, one)],
            edit=WorkspaceEdit(changes={model.uri: model.shown.edits(fix.edits)}),
            is_preferred=len(one.fixes) == 1,
        )
        for one in faults
        if one.span.start <= marked.end and marked.start <= one.span.end
        for fix in one.fixes
    ]
