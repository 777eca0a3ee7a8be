"""Serving of an editor on standard input and output."""

from __future__ import annotations

import logging
import os
import signal
from functools import partial
from typing import BinaryIO

from lsprotocol import types

from torsionnet.app.language_server.editor_answers import code_actions
from torsionnet.app.language_server.model_server import ModelServer
from torsionnet.app.language_server.open_model import CHANGE_DELAY

# Features of the server: each message of an editor with the function that answers it.

TRIGGERS = (" ", ":", "[", ",", "{", ".")
"""Characters after which an editor asks for completion by itself."""
WATCHED = ("**/*.{yaml,yml,json,csv,txt}",)
"""Patterns of the files whose changes by other programs an editor tells, as models may read them."""


def add_features(server: ModelServer) -> None:
    """Make a server answer everything that it can."""
    _add_files(server)
    _add_faults(server)
    _add_writing(server)
    _add_names(server)


def _add_files(server: ModelServer) -> None:
    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    def opened(params: types.DidOpenTextDocumentParams) -> None:
        server.changed(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    def changed(params: types.DidChangeTextDocumentParams) -> None:
        server.changed(params.text_document.uri, CHANGE_DELAY)

    @server.feature(types.TEXT_DOCUMENT_DID_SAVE)
    def saved(params: types.DidSaveTextDocumentParams) -> None:
        server.changed(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    def closed(params: types.DidCloseTextDocumentParams) -> None:
        server.closed(params.text_document.uri)

    @server.feature(types.WORKSPACE_DID_CHANGE_WATCHED_FILES)
    def files_changed(params: types.DidChangeWatchedFilesParams) -> None:
        for change in params.changes:
            server.file_changed(change.uri)

    @server.feature(types.INITIALIZED)
    def initialized(_: types.InitializedParams) -> None:
        workspace = server.client_capabilities.workspace
        watching = workspace.did_change_watched_files if workspace else None
        if watching and watching.dynamic_registration:
            options = types.DidChangeWatchedFilesRegistrationOptions(
                [types.FileSystemWatcher(pattern) for pattern in WATCHED]
            )
            registered = types.Registration("watched-files", types.WORKSPACE_DID_CHANGE_WATCHED_FILES, options)
            server.client_register_capability(types.RegistrationParams([registered]))

    @server.feature(types.SHUTDOWN)
    def shut_down(_: None) -> None:
        server.shut_down = True


def _add_faults(server: ModelServer) -> None:
    @server.feature(
        types.TEXT_DOCUMENT_CODE_ACTION, types.CodeActionOptions(code_action_kinds=[types.CodeActionKind.QuickFix])
    )
    async def actions(params: types.CodeActionParams) -> list[types.CodeAction] | None:
        wanted = params.context.only
        if wanted is not None and not any(_is_quick_fix(kind) for kind in wanted):
            return None
        return await server.answer(
            params.text_document.uri,
            lambda model: code_actions(model, server.faults(model), model.shown.span(params.range)),
        )


def _is_quick_fix(kind: str) -> bool:
    """Whether a kind that an editor asks for comprises quick fixes; a kind comprises those that begin with it."""
    return types.CodeActionKind.QuickFix.value in (kind, kind.partition(".")[0]) or kind == ""


def _add_writing(server: ModelServer) -> None:
    from torsionnet.app.language_server import editor_answers as answers

    @server.feature(types.TEXT_DOCUMENT_COMPLETION, types.CompletionOptions(trigger_characters=list(TRIGGERS)))
    async def complete(params: types.CompletionParams) -> types.CompletionList | None:
        return await server.answer(params.text_document.uri, partial(answers.completion_list, at=params.position))

    @server.feature(types.TEXT_DOCUMENT_HOVER)
    async def hover(params: types.HoverParams) -> types.Hover | None:
        return await server.answer(params.text_document.uri, partial(answers.hover_text, at=params.position))

    @server.feature(types.TEXT_DOCUMENT_FORMATTING)
    async def lay_out(params: types.DocumentFormattingParams) -> list[types.TextEdit] | None:
        return await server.answer(params.text_document.uri, answers.formatting_edits)

    @server.feature(types.TEXT_DOCUMENT_RANGE_FORMATTING)
    async def lay_out_range(params: types.DocumentRangeFormattingParams) -> list[types.TextEdit] | None:
        return await server.answer(params.text_document.uri, partial(answers.formatting_edits, within=params.range))


def _add_names(server: ModelServer) -> None:
    from torsionnet.app.language_server import editor_answers as answers

    @server.feature(types.TEXT_DOCUMENT_DEFINITION)
    async def definition(params: types.DefinitionParams) -> types.Location | None:
        return await server.answer(params.text_document.uri, partial(answers.definition_location, at=params.position))

    @server.feature(types.TEXT_DOCUMENT_REFERENCES)
    async def references(params: types.ReferenceParams) -> list[types.Location] | None:
        with_definition = params.context.include_declaration
        ask = partial(answers.reference_locations, at=params.position, with_definition=with_definition)
        return await server.answer(params.text_document.uri, ask)

    @server.feature(types.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT)
    async def highlight(params: types.DocumentHighlightParams) -> list[types.DocumentHighlight] | None:
        return await server.answer(params.text_document.uri, partial(answers.highlights, at=params.position))

    @server.feature(types.TEXT_DOCUMENT_RENAME, types.RenameOptions(prepare_provider=True))
    async def rename(params: types.RenameParams) -> types.WorkspaceEdit | None:
        ask = partial(answers.renaming, at=params.position, new=params.new_name)
        return await server.answer(params.text_document.uri, ask)

    @server.feature(types.TEXT_DOCUMENT_PREPARE_RENAME)
    async def prepare_rename(params: types.PrepareRenameParams) -> types.Range | None:
        return await server.answer(params.text_document.uri, partial(answers.renamable_range, at=params.position))

    @server.feature(types.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    async def symbols(params: types.DocumentSymbolParams) -> list[types.DocumentSymbol] | None:
        return await server.answer(params.text_document.uri, answers.document_symbols)


# Input of the server that no length in a header can make fill the memory.

MOST_HEADER, MOST_MESSAGE = 8_000, 64_000_000
"""Longest line of a header and longest message that are read, in bytes; model files have at most 4 MB."""
_PIECE = 1_000_000


class GuardedInput:
    """Stream of messages in which one that is too long is passed over, and an empty one stands in its place."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream

    def readline(self) -> bytes:
        """Line of a header."""
        return self._stream.readline(MOST_HEADER)

    def read(self, length: int) -> bytes:
        """Body of a message of that length in bytes; the text ``{}``, which no server answers, of a longer one."""
        if length <= MOST_MESSAGE:
            return self._stream.read(length)
        left = length
        while left > 0:
            piece = self._stream.read(min(left, _PIECE))
            if not piece:
                return b""
            left -= len(piece)
        return b"{}"


INTERRUPTED = 130
"""Exit code after Ctrl-C."""


def serve(requests: BinaryIO, answers: BinaryIO) -> int:
    """Answer an editor until it says that it ends, and return the exit code: 1 where it went away without a word."""
    if not os.environ.get("TORSIONNET_DEBUG"):
        logging.getLogger("pygls").setLevel(logging.CRITICAL)  # what matters goes to the log of the editor
    server = ModelServer()
    add_features(server)
    try:
        server.start_io(GuardedInput(requests), answers)  # type: ignore[arg-type]
    finally:
        server.end()
    return 0 if server.shut_down else 1


def serve_standard_streams() -> int:
    """Answer an editor on standard input and output; whatever else is printed goes to the messages on stderr."""
    # A thread waits for the next message and cannot be interrupted; there is nothing to be saved.
    signal.signal(signal.SIGINT, lambda *_: os._exit(INTERRUPTED))
    requests = os.fdopen(os.dup(0), "rb")
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    return serve(requests, answers)
