"""Language server of model files: what is open, what was found, and serving on standard input and output."""

from __future__ import annotations

import asyncio
import logging
import os
import re
import signal
import traceback
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO, TypeVar
from urllib.parse import unquote

from lsprotocol import types
from pygls.exceptions import JsonRpcException, JsonRpcInvalidRequest, JsonRpcServerNotInitialized
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol
from pygls.uris import to_fs_path, urlparse
from pygls.workspace import TextDocument

from torsionnet.app.language_server.editor_answers import (
    CHANGE_DELAY,
    CheckSchedule,
    EditorText,
    OpenModel,
    code_actions,
    diagnostics,
    faults_in_editor,
    is_model_text,
    names_a_model,
)
from torsionnet.app.text.text_faults import LocatedFault
from torsionnet.base.errors import UsageError
from torsionnet.base.nearby_files import files_recorded, texts_in_editors
from torsionnet.base.version import __version__

# Language server of model files: what is open, what was found in it, and work beside the messages.

# Protocol of the server in which no request stays without an answer, and each document has one address.

_DRIVE = re.compile(r"(?<=^file:///)[A-Z](?=:)")


class AnsweringProtocol(LanguageServerProtocol):
    """Language Server Protocol that answers a request with wrong arguments, too, so that the editor does not wait."""

    def structure_message(self, data: dict[str, Any]) -> Any:
        """Message of the protocol from its JSON, which names an open document by the address that opened it."""
        try:
            message = super().structure_message(data)
        except JsonRpcException as error:
            if "method" in data and isinstance(data.get("id"), (int, str)):
                self._send_response(data["id"], error=error.to_response_error())
            raise
        params = getattr(message, "params", None)
        named = getattr(params, "text_document", None)
        if named is not None and self._workspace is not None:
            opened = [document.uri for document in self._workspace.text_documents.values()]
            named.uri = {_one_spelling(uri): uri for uri in opened}.get(_one_spelling(named.uri), named.uri)
            if isinstance(params, types.DidChangeTextDocumentParams) and named.uri in opened:
                params.content_changes = [self._whole_text(named.uri, params.content_changes)]
        return message

    def _whole_text(
        self, uri: str, changes: Sequence[types.TextDocumentContentChangeEvent]
    ) -> types.TextDocumentContentChangeWholeDocument:
        """Text of a document after changes one after the other, each of all of it or of a range."""
        document = self.workspace.get_text_document(uri)
        text = document.source
        for change in changes:
            if isinstance(change, types.TextDocumentContentChangePartial):
                # pygls counts lines as Python does, which has more breaks than the protocol.
                span = shown_text(document, text).span(change.range)
                text = text[: span.start] + change.text + text[span.end :]
            else:
                text = change.text
        return types.TextDocumentContentChangeWholeDocument(text)

    def handle_message(self, message: Any) -> None:
        """Hand a message to its feature; a request out of its time is refused, as the protocol asks for."""
        method, number = getattr(message, "method", ""), getattr(message, "id", None)
        refused: type[JsonRpcException] | None = None
        if self._shutdown or (method == types.INITIALIZE and self._workspace is not None):
            refused = JsonRpcInvalidRequest
        elif self._workspace is None and method != types.INITIALIZE:
            refused = JsonRpcServerNotInitialized
        if refused is None or method == types.EXIT:
            super().handle_message(message)
        elif method and number is not None:
            self._send_response(number, error=refused().to_response_error())


def _one_spelling(uri: str) -> str:
    """Address in the spelling that stands for all of them, as ``file:///c%3A/a`` and ``file:///C:/a`` are one file.

    >>> _one_spelling("file:///C%3A/100%25%20%41.yaml"), _one_spelling("file:///c:/%2541.yaml")
    ('file:///c:/100% A.yaml', 'file:///c:/%41.yaml')
    """
    return _DRIVE.sub(lambda drive: drive[0].lower(), unquote(uri))


def shown_text(document: TextDocument, text: str) -> EditorText:
    """Text with the counting that was agreed on with the editor of a document."""
    agreed = document.position_codec.encoding or types.PositionEncodingKind.Utf16
    return EditorText(text, types.PositionEncodingKind(agreed).value)


T = TypeVar("T")

REFUSED = types.LSPErrorCodes.RequestFailed.value
"""Code of the protocol for a request that was understood and cannot be met, as a name that is taken."""
WORKERS = 2
"""Threads that answer questions while another one checks."""


class ModelServer(LanguageServer):
    """Language server that knows the open model files, what was found in them and which files they read."""

    def __init__(self) -> None:
        super().__init__(
            "torsionnet",
            __version__,
            text_document_sync_kind=types.TextDocumentSyncKind.Incremental,
            protocol_cls=AnsweringProtocol,
        )
        self.checks = CheckSchedule(self._check)
        self.last_faults: dict[str, tuple[OpenModel, list[LocatedFault]]] = {}
        """Last faults of each open file, with the text in which they are."""
        self.read: dict[str, set[Path]] = {}
        """Files that each open file reads, as far as its last check came."""
        self.models: set[str] = set()
        """Open files that were models once, which they stay while their key is being written."""
        self.shut_down = False
        self._checking = ThreadPoolExecutor(1, "check")
        self._answering = ThreadPoolExecutor(WORKERS, "answer")

    # files

    def open_model(self, uri: str) -> OpenModel | None:
        """Model file that is open under an address; None where it is none, or is not open."""
        document = self._documents().get(uri)
        if document is None:
            return None
        text, path = document.source, to_fs_path(uri)
        file, folder = path or str(urlparse(uri)[2]), Path(path).parent if path else None
        if not is_model_text(text, file) and (uri not in self.models or names_a_model(text)):
            return None
        self.models.add(uri)
        return OpenModel(
            uri, shown_text(document, text), file, folder, {path: other.uri for path, other in self._files().items()}
        )

    def _documents(self) -> dict[str, TextDocument]:
        """Open documents by the address that opened them; the keys of pygls are other ones from version 2.1 on."""
        return {document.uri: document for document in self.workspace.text_documents.values()}

    def _files(self) -> dict[Path, TextDocument]:
        """Open documents that are files, by their resolved path."""
        return {path: document for uri, document in self._documents().items() if (path := _real_path(uri)) is not None}

    def changed(self, uri: str, delay: float = 0.0) -> None:
        """Check a file anew, and the open files that read it."""
        self.checks.ask(uri, delay)
        own = _real_path(uri)
        for other in self._reading(own) - {uri}:
            self.checks.ask(other, max(delay, CHANGE_DELAY))

    def file_changed(self, uri: str) -> None:
        """Check the open files that read a file which another program has changed."""
        for reader in self._reading(_real_path(uri)):
            self.checks.ask(reader, CHANGE_DELAY)

    def _reading(self, path: Path | None) -> set[str]:
        return {uri for uri, read in self.read.items() if path in read}

    def closed(self, uri: str) -> None:
        """Forget a file, and take its diagnostics away."""
        self.checks.drop(uri)
        self.read.pop(uri, None)
        self.models.discard(uri)
        if self.last_faults.pop(uri, None) is not None:
            self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, []))
        for other in self._reading(_real_path(uri)):
            self.checks.ask(other, CHANGE_DELAY)

    # checks

    async def _check(self, uri: str) -> None:
        model = self.open_model(uri)
        if model is None:
            if self.last_faults.pop(uri, None) is not None:
                self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, []))
            return
        version = self._documents()[uri].version
        try:
            faults, shown, read = await self._run(self._checking, uri, lambda: _checked(model))
        except Exception as error:  # noqa: BLE001
            self.tell(f"checking {model.file}", error)
            return
        self.last_faults[uri], self.read[uri] = (model, faults), read
        self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, shown, version))

    def faults(self, model: OpenModel) -> list[LocatedFault]:
        """Faults of a text, found anew where the last ones are of another text."""
        known = self.last_faults.get(model.uri)
        return known[1] if known is not None and known[0] == model else faults_in_editor(model)

    # answers

    async def answer(self, uri: str, calculate: Callable[[OpenModel], T]) -> T | None:
        """Answer to a question on an open model, calculated beside the messages that come in.

        None of a file that is no model, and where the calculation failed, which becomes a message in the log.

        Raises
        ------
        JsonRpcException
            With the sentence of a UsageError.
        """
        model = self.open_model(uri)
        if model is None:
            return None
        try:
            return await self._run(self._answering, uri, lambda: calculate(model))
        except UsageError as error:
            raise JsonRpcException(str(error), REFUSED) from None
        except Exception as error:  # noqa: BLE001
            self.tell(f"answering about {model.file}", error)
            return None

    async def _run(self, workers: ThreadPoolExecutor, uri: str, work: Callable[[], T]) -> T:
        """Result of work in another thread, in which files that are open beside one have the text of the editor."""
        texts = {path: document.source for path, document in self._files().items() if document.uri != uri}

        def with_texts() -> T:
            with texts_in_editors(texts):
                return work()

        return await asyncio.get_running_loop().run_in_executor(workers, with_texts)

    def tell(self, doing: str, error: BaseException) -> None:
        """Write an exception into the log of the editor."""
        shown = "".join(traceback.format_exception(error))
        text = f"torsionnet failed while {doing} (a bug): {shown}"
        self.window_log_message(types.LogMessageParams(types.MessageType.Error, text))

    def report_server_error(self, error: Exception, source: object) -> None:
        """Write what went wrong with a message into the log of the editor, instead of a window before the user."""
        del source
        if isinstance(error, JsonRpcException) and error.code == REFUSED:
            return
        text = f"torsionnet could not answer a message of the editor: {error}"
        self.window_log_message(types.LogMessageParams(types.MessageType.Error, text))

    def end(self) -> None:
        """Stop the threads; a check that is running is not waited for by the editor."""
        for workers in (self._checking, self._answering):
            workers.shutdown(wait=False, cancel_futures=True)


def _checked(model: OpenModel) -> tuple[list[LocatedFault], list[types.Diagnostic], set[Path]]:
    """Faults of a model, its diagnostics, and the files that it reads."""
    with files_recorded() as recorded:
        faults = faults_in_editor(model)
    return faults, diagnostics(model, faults), set(recorded)


def _real_path(uri: str) -> Path | None:
    path = to_fs_path(uri)
    try:
        return Path(path).resolve() if path else None
    except (OSError, RuntimeError, ValueError):
        return None


# Serving of an editor on standard input and output.

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
