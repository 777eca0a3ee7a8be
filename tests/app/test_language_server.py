"""The language server asked by a client over stdio, as an editor asks it."""

import asyncio
import io
import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

pytest.importorskip("pygls", reason='the language server needs pip install "torsionnet[lsp]"')

from click.testing import CliRunner
from support.collecting import OnDemand
from support.patience import PATIENCE

from torsionnet.app.cli.app import app

lsp = OnDemand("lsprotocol.types")
ROOT = Path(__file__).parents[2]
COMMAND = [sys.executable, "-m", "torsionnet", "language-server"]
README = re.search(
    r"```yaml\n(torsionnet: 1\nname: motor and load\n.*?)```",
    (ROOT / "README.md").read_text(encoding="utf-8"),
    re.DOTALL,
)[1]


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
        """Address of a file in the folder, or the address itself."""
        return name if name.startswith("file:") else (self.folder / name).as_uri()

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
        return list(self.told[uri].diagnostics)

    async def anew(self, name="model.yaml"):
        """Diagnostics that come after now."""
        uri = self.uri(name)
        self.told.pop(uri, None)
        await self.until(lambda: uri in self.told)
        return list(self.told[uri].diagnostics)


def finished(work):
    """Result of asynchronous work, done in a thread of its own: in this one a browser of another test may have a loop."""
    return in_own_thread(asyncio.run, work)


def in_own_thread(call, *arguments):
    """Result of a call in another thread, which has no loop of events."""
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(call, *arguments).result()


def session(folder, talk, encodings=None):
    """Talk of an editor with a server of its own in this process, from the first message to the exit.

    A process takes half a second to start; what only a process shows, the tests with `COMMAND` see.
    """

    from pygls.lsp.client import LanguageClient

    from torsionnet.app.language_server.model_server import serve

    listening = socket.create_server(("127.0.0.1", 0))

    def served():
        with listening, listening.accept()[0] as connection, connection.makefile("rb") as requests:
            return serve(requests, connection.makefile("wb"))

    async def all_of_it():
        client = LanguageClient("test", "1")
        editor = Editor(client, folder)
        code = asyncio.get_running_loop().run_in_executor(None, served)
        await client.start_tcp(*listening.getsockname())
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
            assert await asyncio.wait_for(code, PATIENCE) == 0
            await client.stop()
        return editor

    return finished(all_of_it())


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
        assert {(4, "wrong-unit"), (5, "unknown-entry")} <= {(one.range.start.line, one.code) for one in errors}
        assert {one.source for one in faults} == {"torsionnet"}
        editor.change(README)
        assert await editor.faults() == [] or all(
            one.severity != lsp.DiagnosticSeverity.Error for one in await editor.faults()
        )

    editor = session(tmp_path, talk)
    assert editor.start.server_info.name == "torsionnet"
    assert editor.start.capabilities.position_encoding == "utf-16"
    assert editor.logged == []


def with_error(faults):
    return [one for one in faults if one.severity == lsp.DiagnosticSeverity.Error]


def at(editor, word, name="model.yaml", units=len):
    """Arguments of a question on the word in a file."""
    return {
        "text_document": lsp.TextDocumentIdentifier(editor.uri(name)),
        "position": place(editor.texts[name], word, units),
    }


def test_what_mends_a_fault_is_offered_at_its_place_and_makes_it_vanish(tmp_path):
    wrong = README.replace("stiffness: k_1", "stifness: k_1")

    async def talk(editor):
        document = editor.open(wrong)
        (fault,) = with_error(await editor.faults())
        context = lsp.CodeActionContext([fault])
        actions = await editor.client.text_document_code_action_async(
            lsp.CodeActionParams(document, fault.range, context)
        )
        (action,) = [one for one in actions if '"stiffness"' in one.title]
        assert action.kind == lsp.CodeActionKind.QuickFix
        assert list(action.diagnostics) == [fault]
        mended = applied(wrong, action.edit.changes[document.uri])
        assert mended == README
        editor.change(mended)
        assert with_error(await editor.faults()) == []

        # elsewhere, and where an editor wants to refactor, there is nothing to mend
        start = lsp.Range(lsp.Position(0, 0), lsp.Position(0, 3))
        assert not await editor.client.text_document_code_action_async(lsp.CodeActionParams(document, start, context))
        refactor = lsp.CodeActionContext([fault], only=[lsp.CodeActionKind.Refactor])
        editor.change(wrong)
        assert not await editor.client.text_document_code_action_async(
            lsp.CodeActionParams(document, fault.range, refactor)
        )

    assert session(tmp_path, talk).logged == []


def test_names_are_found_and_renamed_in_the_whole_file(tmp_path):
    from pygls.exceptions import JsonRpcException

    async def talk(editor):
        document = editor.open(README)
        client = editor.client
        node = at(editor, "b], stiff")
        allowed = await client.text_document_prepare_rename_async(lsp.PrepareRenameParams(**node))
        assert extent(allowed) == (5, 35, 5, 36)
        changed = await client.text_document_rename_async(lsp.RenameParams(**node, new_name="hub"))
        text = applied(README, changed.changes[document.uri])
        assert text == README.replace("[a, b]", "[a, hub]").replace("[b, c]", "[hub, c]")
        editor.change(text)
        assert with_error(await editor.faults()) == []
        editor.change(README)

        with pytest.raises(JsonRpcException, match="a") as refused:
            await client.text_document_rename_async(lsp.RenameParams(**node, new_name="a"))
        assert refused.value.code == lsp.LSPErrorCodes.RequestFailed
        with pytest.raises(JsonRpcException):
            await client.text_document_rename_async(lsp.RenameParams(**at(editor, "type: spring"), new_name="x"))
        assert (
            await client.text_document_prepare_rename_async(lsp.PrepareRenameParams(**at(editor, "type: spring")))
            is None
        )

        parameter = at(editor, "k_1, damping")
        defined = await client.text_document_definition_async(lsp.DefinitionParams(**parameter))
        assert defined.uri == document.uri
        assert extent(defined.range)[:2] == (2, 13)
        everywhere = await client.text_document_references_async(
            lsp.ReferenceParams(lsp.ReferenceContext(True), **parameter)
        )
        assert [extent(one.range) for one in everywhere] == [(2, 13, 2, 16), (5, 50, 5, 53)]
        used = await client.text_document_references_async(
            lsp.ReferenceParams(lsp.ReferenceContext(False), **parameter)
        )
        assert [extent(one.range) for one in used] == [(5, 50, 5, 53)]
        marked = await client.text_document_document_highlight_async(lsp.DocumentHighlightParams(**parameter))
        assert [(extent(one.range), one.kind) for one in marked] == [
            ((2, 13, 2, 16), lsp.DocumentHighlightKind.Write),
            ((5, 50, 5, 53), lsp.DocumentHighlightKind.Read),
        ]

    assert session(tmp_path, talk).logged == []


@pytest.mark.parametrize(
    "spelling",
    [
        "file:///models/a%20b/model.yaml",
        "file:///models/a b/ä.yaml",
        "file:///models/Pr%C3%BCfst%C3%A4nde/model.yaml",
        "file:///c%3A/Users/b/model.yaml",
        "file:///C:/Users/b/model.yaml",
        "file:///models/100%25.yaml",
        "file:///models/%2541.yaml",
    ],
)
def test_answers_have_the_address_that_the_editor_sent(tmp_path, spelling):
    """Also where no such file is on this machine, and the text is in the editor alone."""

    async def talk(editor):
        client = editor.client
        document = editor.open(README.replace("stiffness: k_1", "stifness: k_1"), spelling)
        (fault,) = with_error(await editor.faults(spelling))
        actions = await client.text_document_code_action_async(
            lsp.CodeActionParams(document, fault.range, lsp.CodeActionContext([fault]))
        )
        assert {address for action in actions for address in action.edit.changes} == {spelling}
        editor.change(README, spelling)
        assert with_error(await editor.faults(spelling)) == []

        parameter = at(editor, "k_1, damping", spelling)
        assert await client.text_document_hover_async(lsp.HoverParams(**parameter)) is not None
        defined = await client.text_document_definition_async(lsp.DefinitionParams(**parameter))
        used = await client.text_document_references_async(lsp.ReferenceParams(lsp.ReferenceContext(True), **parameter))
        assert {one.uri for one in [defined, *used]} == {spelling}
        renamed = await client.text_document_rename_async(lsp.RenameParams(**parameter, new_name="k_2"))
        assert applied(README, renamed.changes.pop(spelling)) == README.replace("k_1", "k_2")
        assert not renamed.changes

        client.text_document_did_close(lsp.DidCloseTextDocumentParams(document))
        assert await editor.anew(spelling) == []
        assert set(editor.told) == {spelling}

    assert session(tmp_path, talk).logged == []


def test_two_spellings_of_an_address_are_one_document(tmp_path):
    opened, other = "file:///c%3A/Users/a%20b/100%25.yaml", "file:///C:/Users/a b/%3100%25.yaml"

    async def talk(editor):
        editor.open(README, opened)
        assert with_error(await editor.faults(opened)) == []
        editor.versions[other] = editor.versions[opened]
        editor.change(README.replace("0.078 kg*m^2", "0.078 N*m"), other)
        await editor.until(lambda: editor.told[opened].version == editor.versions[other])
        assert len(with_error(editor.told[opened].diagnostics)) == 1
        defined = await editor.client.text_document_definition_async(
            lsp.DefinitionParams(**at(editor, "k_1, damping", other))
        )
        assert defined.uri == opened
        editor.client.text_document_did_close(lsp.DidCloseTextDocumentParams(lsp.TextDocumentIdentifier(other)))
        assert await editor.anew(opened) == []

        # a name with a literal percent sign, and the one that it would be if it were unquoted twice
        wrong = README.replace("stiffness: k_1", "stifness: k_1")
        editor.open(wrong, "file:///models/%2541.yaml")
        editor.open(README, "file:///models/A.yaml")
        assert len(with_error(await editor.faults("file:///models/%2541.yaml"))) == 1
        assert with_error(await editor.faults("file:///models/A.yaml")) == []

    assert session(tmp_path, talk).logged == []


def test_outline_and_explanations(tmp_path):
    async def talk(editor):
        document = editor.open(README)
        symbols = await editor.client.text_document_document_symbol_async(lsp.DocumentSymbolParams(document))
        (elements,) = [one for one in symbols if one.name == "elements"]
        assert [one.name for one in elements.children] == ["motor", "shaft", "stage", "load"]
        assert extent(elements.children[1].selection_range) == (5, 2, 5, 7)
        said = await editor.client.text_document_hover_async(lsp.HoverParams(**at(editor, "k_1, damping")))
        assert said.contents.kind == lsp.MarkupKind.Markdown
        assert "13300" in said.contents.value.replace(" ", "").replace(",", "") or "13.3" in said.contents.value
        assert extent(said.range) == (5, 50, 5, 53)

    assert session(tmp_path, talk).logged == []


def test_completion_offers_what_fits_and_its_edits_can_be_put_in(tmp_path):
    begun = README.replace("type: gear, nodes: [b, c], ratio: tau", "type: ge")

    async def talk(editor):
        editor.open(begun)
        assert set(editor.start.capabilities.completion_provider.trigger_characters) == set(" :[,{.")
        where = at(editor, "ge}")
        where["position"] = lsp.Position(where["position"].line, where["position"].character + 2)
        offered = await editor.client.text_document_completion_async(lsp.CompletionParams(**where))
        (gear,) = [one for one in offered.items if one.label == "gear"]
        assert "type: gear" in applied(begun, [gear.text_edit])
        assert gear.insert_text_mode == lsp.InsertTextMode.AsIs
        labels = {one.label for one in offered.items}
        assert "inertia" not in labels or len(labels) > 10

        # a node that is there already, after the bracket that asks by itself
        text = README.replace("nodes: [b, c]", "nodes: [")
        editor.change(text)
        where = at(editor, "[, ratio")
        where["position"] = lsp.Position(where["position"].line, where["position"].character + 1)
        offered = await editor.client.text_document_completion_async(lsp.CompletionParams(**where))
        assert {"a", "b", "c"} <= {one.label for one in offered.items}
        assert offered.is_incomplete  # else the editor itself would match digits with names

        # nothing that Enter could hang on a number
        where = at(editor, "4.14")
        where["position"] = lsp.Position(where["position"].line, where["position"].character + 4)
        offered = await editor.client.text_document_completion_async(lsp.CompletionParams(**where))
        assert not (offered and offered.items)

    assert session(tmp_path, talk).logged == []


def test_formatting_changes_the_layout_alone(tmp_path):
    untidy = README.replace("name: motor", "name:   motor  ").replace("stage: {", "stage:   {")

    async def talk(editor):
        document = editor.open(untidy)
        options = lsp.FormattingOptions(2, insert_spaces=True)
        edits = await editor.client.text_document_formatting_async(lsp.DocumentFormattingParams(document, options))
        assert edits
        tidy = applied(untidy, edits)
        assert "stage: {" in tidy
        assert "name: motor" in tidy
        line = next(number for number, one in enumerate(untidy.splitlines()) if "stage:" in one)
        only = lsp.Range(lsp.Position(line, 0), lsp.Position(line + 1, 0))
        edits = await editor.client.text_document_range_formatting_async(
            lsp.DocumentRangeFormattingParams(document, only, options)
        )
        some = applied(untidy, edits)
        assert "stage: {" in some
        assert "name:   motor" in some

    assert session(tmp_path, talk).logged == []


TAU = "\N{MATHEMATICAL ITALIC SMALL TAU}\N{GREEK SMALL LETTER TAU}"
GREEK = README.replace("motor: {", f'motor: {{description: "{TAU}", ').replace("0.078 kg*m^2", "0.078 N*m")


def utf16_units(text):
    return len(text.encode("utf-16-le")) // 2


def utf8_units(text):
    return len(text.encode("utf-8"))


@pytest.mark.parametrize(
    ("encodings", "agreed", "units"),
    [
        (None, "utf-16", utf16_units),
        (["utf-32", "utf-16"], "utf-32", len),
        (["utf-8"], "utf-8", utf8_units),
        (["utf-7"], "utf-16", utf16_units),
    ],
)
def test_columns_count_as_agreed_with_the_editor(tmp_path, encodings, agreed, units):
    line = next(one for one in GREEK.splitlines() if "0.078 N*m" in one)
    start = units(line[: line.index("0.078")])

    async def talk(editor):
        assert editor.start.capabilities.position_encoding == agreed
        editor.open(GREEK)
        assert (4, start, 4, start + 9) in [extent(one.range) for one in with_error(await editor.faults())]
        defined = await editor.client.text_document_definition_async(
            lsp.DefinitionParams(**at(editor, "k_1, damping", units=units))
        )
        assert extent(defined.range)[:2] == (2, 13)

    session(tmp_path, talk, encodings)


BREAKS = re.compile("\r\n|\n|\r")


def protocol_place(text, offset):
    """Position of a character as the protocol counts: three kinds of line breaks, units of UTF-16."""
    before = text[:offset]
    line = len(BREAKS.findall(before))
    start = max((one.end() for one in BREAKS.finditer(before)), default=0)
    return lsp.Position(line, utf16_units(text[start:offset]))


@pytest.mark.parametrize("breaks", ["\n", "\r\n"])
def test_changes_of_ranges_make_the_text_that_the_editor_shows(tmp_path, breaks):
    # A line separator and a next line are characters for an editor, line breaks for Python.
    text = GREEK.replace("\n", " # \U0001d70f \u2028 \x85 end\n", 2).replace("\n", breaks)
    changes = [("0.078", "0.079"), ("end", f"end{breaks}# of \u2028 it"), ("k_1,", "k_9,"), ("", breaks)]

    async def talk(editor):
        from lsprotocol.types import TextDocumentContentChangePartial, VersionedTextDocumentIdentifier

        editor.open(text)
        await editor.faults()
        now, sent = text, []
        for old, new in changes:
            start = now.index(old) if old else len(now)
            shown = lsp.Range(protocol_place(now, start), protocol_place(now, start + len(old)))
            sent.append(TextDocumentContentChangePartial(text=new, range=shown))
            now = now[:start] + new + now[start + len(old) :]
        editor.versions["model.yaml"] += 1
        document = VersionedTextDocumentIdentifier(editor.versions["model.yaml"], editor.uri("model.yaml"))
        editor.client.text_document_did_change(lsp.DidChangeTextDocumentParams(document, sent))
        editor.open(now, "same.yaml")
        changed = [(extent(one.range), one.message) for one in await editor.faults()]
        assert changed == [(extent(one.range), one.message) for one in await editor.faults("same.yaml")]
        assert any("k_9" in words for _, words in changed)

    session(tmp_path, talk)


@pytest.mark.parametrize(
    ("sent", "code"),
    [
        (lambda: request(5, "textDocument/hover", HOVER) + START + END, -32002),
        (lambda: START + request(5, "initialize", {"processId": None, "rootUri": None, "capabilities": {}}) + END, -32600),
        (lambda: START + request(98, "shutdown") + request(5, "textDocument/hover", HOVER) + END, -32600),
    ],
    ids=["before the start", "second start", "after the end"],
)  # fmt: skip
def test_a_request_out_of_its_time_is_refused(sent, code):
    found, ended = answers_here(sent())
    assert next(one for one in found if one.get("id") == 5)["error"]["code"] == code
    assert ended == 0


def test_only_models_are_checked(tmp_path):
    others = {
        "compose.yaml": "services:\n  web: {image: nginx}\n",
        "study.yaml": "torsionnet: 1\nmodel: amt_rig\nvary: {k: {}}\nquantities: {}\n",
        "empty.yaml": "",
    }

    async def talk(editor):
        for name, text in others.items():
            document = editor.open(text, name)
            assert not await editor.client.text_document_document_symbol_async(lsp.DocumentSymbolParams(document))
        editor.open("", "new.torsionnet.yaml")
        (fault,) = await editor.faults("new.torsionnet.yaml")
        assert fault.message.startswith("the file is empty")
        editor.open(README)
        await editor.faults()
        assert {editor.uri(name) for name in others}.isdisjoint(editor.told)

        # the key of a model may be written anew while its faults stay, and go when it is closed
        editor.change(README.replace("torsionnet: 1", "torsionnt: 1"))
        assert "unknown key" in with_error(await editor.faults())[0].message
        editor.client.text_document_did_close(
            lsp.DidCloseTextDocumentParams(lsp.TextDocumentIdentifier(editor.uri("model.yaml")))
        )
        assert await editor.anew() == []

    assert session(tmp_path, talk).logged == []


HALVES = """torsionnet: 1
parts:
  half:
    ports: [a]
    elements:
      disc: {type: inertia, node: a, inertia: 2 kg*m^2}
"""
USING = README.replace("elements:", "include: [halves.yaml]\nuse: {h: {part: half, at: {a: b}}}\nelements:")


def test_included_files_count_as_the_editor_shows_them(tmp_path):
    async def talk(editor):
        halves = editor.uri("halves.yaml").replace("halves", "h%61lves")
        editor.open(USING)
        assert any("there is no file" in one.message for one in await editor.faults())
        (tmp_path / "halves.yaml").write_text(HALVES, encoding="utf-8")
        editor.client.workspace_did_change_watched_files(
            lsp.DidChangeWatchedFilesParams([lsp.FileEvent(editor.uri("halves.yaml"), lsp.FileChangeType.Created)])
        )
        assert with_error(await editor.anew()) == []

        editor.open(HALVES, halves)
        assert await editor.faults(halves) == []  # no model, and used elsewhere
        editor.told.clear()
        editor.change(HALVES.replace("2 kg*m^2", "2 kg*m"), halves)  # and not saved
        await editor.until(lambda: editor.uri("model.yaml") in editor.told)
        (fault,) = with_error(editor.told[editor.uri("model.yaml")].diagnostics)
        assert fault.code == "wrong-unit"
        (own,) = await editor.faults(halves)
        assert extent(own.range) == (5, 46, 5, 52)
        assert [one.method for one in editor.registered] == ["workspace/didChangeWatchedFiles"]

        # where the ports are defined, by the address that the editor gave the file, and by its own one
        editor.change(HALVES, halves)
        editor.change(USING.replace("{a: b}", "{z: b}"))
        related = [one for fault in await editor.faults() for one in fault.related_information or []]
        assert {(one.message, one.location.uri) for one in related} == {("defined here", halves)}
        editor.client.text_document_did_close(lsp.DidCloseTextDocumentParams(lsp.TextDocumentIdentifier(halves)))
        related = [one for fault in await editor.anew() for one in fault.related_information or []]
        assert {one.location.uri for one in related} == {editor.uri("halves.yaml")}

    assert session(tmp_path, talk).logged == []


def test_related_places_are_told(tmp_path):
    """A fault in a part is told with the place where the part is used."""
    text = USING.replace(
        "include: [halves.yaml]\n",
        "parts:\n  half: {ports: [a], parameters: {J: 1 kg*m}, elements: {disc: {type: inertia, node: a, inertia: J}}}\n",
    )

    async def talk(editor):
        editor.open(text)
        related = [one for fault in await editor.faults() for one in fault.related_information or []]
        assert related
        assert {one.location.uri for one in related} == {editor.uri("model.yaml")}
        assert "used here" in {one.message for one in related}

    assert session(tmp_path, talk).logged == []


def test_the_newest_text_wins(tmp_path):
    """Of many changes in a row the last one is checked; what is told belongs to the version that it names."""

    async def talk(editor):
        editor.open(README)
        for number in range(40):
            editor.change(README.replace("0.078 kg*m^2", f"{number} kg*m" if number < 39 else "1 kg*m^2"))
        assert with_error(await editor.faults()) == []
        await asyncio.sleep(0.5)
        assert editor.told[editor.uri("model.yaml")].version == 41

    assert session(tmp_path, talk).logged == []


def test_what_is_typed_over_is_not_checked():
    from torsionnet.app.language_server.editor_answers import CheckSchedule

    checked = []

    async def check(uri):
        checked.append(uri)

    async def typed():
        schedule = CheckSchedule(check)
        for _ in range(40):
            schedule.ask("typed", 0.05)
            schedule.ask("other", 0.05)
            await asyncio.sleep(0)  # the check before has begun to wait
        schedule.drop("other")
        while schedule._tasks:
            await asyncio.sleep(0.01)

    finished(typed())
    assert checked == ["typed"]


def large(springs):
    lines = [f"  s{i}: {{type: spring, nodes: [n{i}, n{i + 1}], stiffness: 1 kN*m/rad}}\n" for i in range(springs)]
    discs = [f"  d{i}: {{type: inertia, node: n{i}, inertia: 1 kg*m^2}}\n" for i in range(springs + 1)]
    return "".join(["torsionnet: 1\nname: large\nelements:\n", *lines, *discs])


def test_a_model_of_2000_elements_is_checked_while_questions_are_answered(tmp_path):
    text = large(1000)

    async def talk(editor):
        editor.open(text, "large.yaml")
        editor.open(README)
        (remark,) = await editor.faults("large.yaml")
        assert "one rigid-body mode" in remark.message
        editor.change(text.replace("n1000, inertia: 1 kg*m^2", "n1000, inertia: 1 kg*m"), "large.yaml")
        said = await editor.client.text_document_prepare_rename_async(
            lsp.PrepareRenameParams(**at(editor, "b], stiff"))
        )
        assert extent(said) == (5, 35, 5, 36)
        (wrong,) = with_error(await editor.faults("large.yaml"))
        assert extent(wrong.range) == (2003, 47, 2003, 53)

    assert session(tmp_path, talk).logged == []


def message(content):
    body = content if isinstance(content, bytes) else json.dumps(content).encode()
    return b"Content-Length: %d\r\n\r\n%s" % (len(body), body)


def request(number, method, params=None):
    return message({"jsonrpc": "2.0", "id": number, "method": method, "params": params})


def notice(method, params=None):
    return message({"jsonrpc": "2.0", "method": method, "params": params})


START = request(1, "initialize", {"processId": None, "rootUri": None, "capabilities": {}})
END = request(99, "shutdown") + notice("exit")
HOVER = {"textDocument": {"uri": "file:///models/model.yaml"}, "position": {"line": 4, "character": 3}}


def answers(sent):
    """What the server answers to bytes on its standard input, as JSON, and the finished process."""
    done = subprocess.run(COMMAND, input=sent, capture_output=True, timeout=PATIENCE, check=False, cwd=ROOT)
    return messages(done.stdout), done


def answers_here(sent):
    """The same of a server in this process, and its exit code."""
    from torsionnet.app.language_server.model_server import serve

    class Written(io.BytesIO):
        def close(self):
            """Keep what was written."""

    written = Written()
    code = in_own_thread(serve, io.BytesIO(sent), written)
    return messages(written.getvalue()), code


def messages(rest):
    """What bytes hold, which is nothing but messages of the protocol."""
    found = []
    while rest:
        header, _, rest = rest.partition(b"\r\n\r\n")
        length = int(re.search(rb"Content-Length: (\d+)", header)[1])
        found.append(json.loads(rest[:length]))
        rest = rest[length:]
    return found


def opened(text, uri="file:///models/model.yaml"):
    return notice(
        "textDocument/didOpen", {"textDocument": {"uri": uri, "languageId": "yaml", "version": 1, "text": text}}
    )


BROKEN = {
    "no JSON": message(b"{{{{"),
    "no object": message([1, 2, 3]) + message("x") + message(None),
    "no protocol": message({"id": 5}),
    "other headers": b"garbage\r\n\r\nX-Length: 3\r\n\r\n",
    "wrong arguments": request(5, "textDocument/hover", {"nonsense": 1}),
    "places outside": request(
        5,
        "textDocument/hover",
        {"textDocument": {"uri": "file:///x.yaml"}, "position": {"line": -3, "character": 10**12}},
    ),
    "unknown request": request(5, "no/such", {}),
    "unknown notice": notice("no/such", {}),
    "change of what is not open": notice(
        "textDocument/didChange",
        {"textDocument": {"uri": "file:///x.yaml", "version": 3}, "contentChanges": [{"text": "a"}]},
    ),
    "deep": message(b"[" * 100_000),
    "addresses": opened(README, "file:///a%00b.yaml")
    + opened(README, "untitled:Untitled-1")
    + opened(README, "http://[x"),
    "half a character": opened(README.replace("motor and", "\ud800 \ufeff \x00 \x1b[2J")),
    "many anchors": opened("torsionnet: 1\na: &a [1,1]\n" + "".join(f"b{i}: &b{i} [*a,*a]\n" for i in range(999))),
    "deep YAML": opened("torsionnet: 1\nelements: " + "[" * 5000),
    "outside the folder": opened(README + "include: [../../etc/passwd, /etc/passwd, C:/x]\n"),
}


@pytest.mark.few(4, 3)
@pytest.mark.parametrize("broken", BROKEN)
def test_no_message_ends_the_server(broken, capfd):
    found, code = answers_here(START + BROKEN[broken] + request(7, "textDocument/hover", HOVER) + END)
    numbers = [one["id"] for one in found if "id" in one]
    assert {1, 7, 99} <= set(numbers)
    assert code == 0
    assert "Traceback" not in capfd.readouterr().err
    if "request" in broken or "arguments" in broken or "places" in broken:
        assert next(one for one in found if one.get("id") == 5)["error"]["code"] in (-32601, -32602)


def test_a_message_that_is_too_long_is_passed_over():
    from torsionnet.app.language_server import model_server as guarded_input

    long = guarded_input.MOST_MESSAGE + 1
    stream = guarded_input.GuardedInput(io.BytesIO(b"x" * long + message({"a": 1})))
    assert stream.read(long) == b"{}"
    assert stream.readline() == b"Content-Length: 8\r\n"
    assert guarded_input.GuardedInput(io.BytesIO(b"short")).read(10**15) == b""


def test_a_process_ends_as_the_editor_says_or_goes_away():
    found, done = answers(START + BROKEN["no JSON"] + request(7, "textDocument/hover", HOVER) + END)
    assert [one["id"] for one in found if "id" in one] == [1, 7, 99]
    assert (done.returncode, b"Traceback" in done.stderr) == (0, False)
    found, done = answers(START)
    assert [one["id"] for one in found] == [1]
    assert done.returncode == 1  # it did not say goodbye


@pytest.mark.skipif(os.name == "nt", reason="Windows sends no SIGINT to one process")
def test_ctrl_c_ends_a_server_that_somebody_started_by_hand():
    with subprocess.Popen(COMMAND, stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=ROOT) as process:
        process.stdin.write(START)
        process.stdin.flush()
        assert process.stdout.readline().startswith(b"Content-Length")
        process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE) == 130


@pytest.mark.parametrize(("before", "after", "offered"), [(3, 0, True), (3, -1, False), (0, 3, True), (-1, 3, False)])
def test_mending_is_offered_where_the_marked_stretch_touches_the_fault(before, after, offered):
    """In this process: stretches that end or begin at the fault, and beside it."""
    from torsionnet.app.language_server.editor_answers import EditorText, OpenModel, code_actions
    from torsionnet.app.text.text_edits import TextSpan
    from torsionnet.app.text.text_faults import text_faults

    model = OpenModel("file:///model.yaml", EditorText(README.replace("stiffness: k_1", "stifness: k_1")), "", None)
    faults = [one for one in text_faults(model.text) if one.fixes]
    (span,) = {one.span for one in faults}
    marked = (
        TextSpan(span.start - before, span.start + after) if before == 3 else TextSpan(span.end - before, span.end + 3)
    )
    assert bool(code_actions(model, faults, marked)) == offered


def test_a_failing_service_becomes_a_message_in_the_log(monkeypatch):
    """Tried in this process, with a service that is broken on purpose."""
    from torsionnet.app.language_server.editor_answers import EditorText, OpenModel
    from torsionnet.app.language_server.model_server import ModelServer

    server, told = ModelServer(), []
    model = OpenModel("file:///model.yaml", EditorText(README), "/model.yaml", None)
    monkeypatch.setattr(server, "open_model", lambda _: model)
    monkeypatch.setattr(server, "window_log_message", lambda params: told.append(params.message))
    monkeypatch.setattr(type(server), "workspace", type("NoFiles", (), {"text_documents": {}})())

    def broken(_):
        raise ZeroDivisionError("by nothing")

    assert finished(server.answer(model.uri, broken)) is None
    server.end()
    assert "answering about /model.yaml (a bug)" in told[0]
    assert "ZeroDivisionError: by nothing" in told[0]


def test_without_the_extra_the_command_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "pygls.lsp.server", None)
    shown = CliRunner().invoke(app, ["language-server"])
    assert shown.exit_code == 4
    assert 'pip install "torsionnet[lsp]"' in shown.stderr
    assert shown.stdout == ""


def test_positions_are_those_of_the_protocol():
    """Its lines end at line feed, carriage return or both; YAML and Python know more ends."""
    from torsionnet.app.language_server.editor_answers import EditorText

    text = EditorText("a\r\nb\u2028c\x0cd\re\U0001d70ff\n")
    assert [text.position(text.text.index(char)) for char in "abcdef"] == [
        lsp.Position(0, 0), lsp.Position(1, 0), lsp.Position(1, 2), lsp.Position(1, 4), lsp.Position(2, 0), lsp.Position(2, 3),
    ]  # fmt: skip
    for offset in range(len(text.text) + 1):
        assert text.offset(text.position(offset)) in (offset, offset - 1)  # between CR and LF there is no place
    assert text.offset(lsp.Position(0, 99)) == 1
    assert text.offset(lsp.Position(99, 0)) == len(text.text)
