"""The language server asked by a client over stdio, as an editor asks it."""

import asyncio
import re
import sys
import time
from pathlib import Path

import pytest

pytest.importorskip("pygls", reason='the language server needs pip install "torsionnet[lsp]"')

from lsprotocol import types as lsp
from pygls.lsp.client import LanguageClient

ROOT = Path(__file__).parents[1]
COMMAND = [sys.executable, "-m", "torsionnet", "language-server"]
README = re.search(
    r"```yaml\n(torsionnet: 1\nname: motor and load\n.*?)```",
    (ROOT / "README.md").read_text(encoding="utf-8"),
    re.DOTALL,
)[1]
PATIENCE = 60
"""Time in s after which an answer counts as missing, on the slowest machine."""


class Editor:
    """An editor with some open files, which keeps what the server tells."""

    def __init__(self, client, folder):
        self.client, self.folder = client, folder
        self.told, self.logged, self.registered = {}, [], []
        self.versions, self.texts = {}, {}
        self.news = asyncio.Event()

        @client.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def published(params):
            self.told[params.uri] = params
            self.news.set()

        @client.feature(lsp.WINDOW_LOG_MESSAGE)
        def logged(params):
            self.logged.append(params.message)
            self.news.set()

        @client.feature(lsp.CLIENT_REGISTER_CAPABILITY)
        def registered(params):
            self.registered += params.registrations

    def uri(self, name):
        return (self.folder / name).as_uri()

    def open(self, text, name="model.yaml"):
        self.versions[name], self.texts[name] = 1, text
        document = lsp.TextDocumentItem(self.uri(name), "yaml", 1, text)
        self.client.text_document_did_open(lsp.DidOpenTextDocumentParams(document))
        return lsp.TextDocumentIdentifier(self.uri(name))

    def change(self, text, name="model.yaml"):
        self.versions[name] += 1
        self.texts[name] = text
        document = lsp.VersionedTextDocumentIdentifier(self.versions[name], self.uri(name))
        change = lsp.TextDocumentContentChangeWholeDocument(text)
        self.client.text_document_did_change(lsp.DidChangeTextDocumentParams(document, [change]))

    async def until(self, holds):
        """Wait for something that the server tells."""
        end = time.monotonic() + PATIENCE
        while not holds():
            assert time.monotonic() < end, (self.told, self.logged)
            self.news.clear()
            try:
                await asyncio.wait_for(self.news.wait(), 1)
            except TimeoutError:
                continue

    async def faults(self, name="model.yaml"):
        """Diagnostics of the newest text of a file."""
        uri = self.uri(name)
        await self.until(lambda: uri in self.told and self.told[uri].version == self.versions[name])
        return self.told[uri].diagnostics

    async def anew(self, name="model.yaml"):
        """Diagnostics that come after now."""
        uri = self.uri(name)
        self.told.pop(uri, None)
        await self.until(lambda: uri in self.told)
        return self.told[uri].diagnostics


def session(folder, talk, encodings=None):
    """Talk of an editor with a server of its own, from the first message to the exit."""

    async def all_of_it():
        client = LanguageClient("test", "1")
        editor = Editor(client, folder)
        await client.start_io(*COMMAND, cwd=ROOT)
        general = lsp.GeneralClientCapabilities(position_encodings=encodings) if encodings else None
        watching = lsp.DidChangeWatchedFilesClientCapabilities(dynamic_registration=True)
        workspace = lsp.WorkspaceClientCapabilities(did_change_watched_files=watching)
        capabilities = lsp.ClientCapabilities(general=general, workspace=workspace)
        editor.start = await asyncio.wait_for(
            client.initialize_async(lsp.InitializeParams(capabilities, root_uri=folder.as_uri())), PATIENCE
        )
        client.initialized(lsp.InitializedParams())
        try:
            await talk(editor)
        finally:
            await asyncio.wait_for(client.shutdown_async(None), PATIENCE)
            client.exit(None)
            await asyncio.wait_for(client._server.wait(), PATIENCE)
            await client.stop()
        assert client._server.returncode == 0
        return editor

    return asyncio.run(all_of_it())


def extent(shown):
    return (shown.start.line, shown.start.character, shown.end.line, shown.end.character)


def found(faults):
    return [(extent(one.range), one.message.partition(";")[0]) for one in faults]


def place(text, word, units=len):
    """Position of the first character of a word in a text."""
    before = text[: text.index(word)]
    return lsp.Position(before.count("\n"), units(before.rpartition("\n")[2]))


def applied(text, edits):
    """Text after edits, on lines of ASCII."""
    starts = [0, *(found.end() for found in re.finditer("\n", text))]
    spans = [
        (
            starts[e.range.start.line] + e.range.start.character,
            starts[e.range.end.line] + e.range.end.character,
            e.new_text,
        )
        for e in edits
    ]
    for start, end, new in sorted(spans, reverse=True):
        text = text[:start] + new + text[end:]
    return text


def test_faults_come_and_go_with_the_text(tmp_path):
    async def talk(editor):
        editor.open(README)
        assert not [one for one in await editor.faults() if one.severity == lsp.DiagnosticSeverity.Error]
        editor.change(
            README.replace("0.078 kg*m^2", "0.078 N*m")
            .replace("nodes: [b, c]", "nodes: [bb, c]")
            .replace("stiffness: k_1", "stifness: k_1")
        )
        faults = await editor.faults()
        errors = [one for one in faults if one.severity == lsp.DiagnosticSeverity.Error]
        assert ((4, 43, 4, 52), '"0.078 N*m" is not a value of inertia') in found(errors)
        assert ((5, 39, 5, 47), 'unknown key "stifness"') in found(errors)
        assert {one.source for one in faults} == {"torsionnet"}
        editor.change(README)
        assert await editor.faults() == [] or all(
            one.severity != lsp.DiagnosticSeverity.Error for one in await editor.faults()
        )

    editor = session(tmp_path, talk)
    assert editor.start.server_info.name == "torsionnet"
    assert editor.start.capabilities.position_encoding == "utf-16"
    assert editor.logged == []
