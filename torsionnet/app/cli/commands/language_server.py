"""Command ``torsionnet language-server``, which answers an editor that model files are written in."""

from __future__ import annotations

import sys

from torsionnet.app.cli.command import Answer, Command, click_command
from torsionnet.app.cli.terminal import message

LSP_NEEDED = 'the language server needs the package pygls: pip install "torsionnet[lsp]"'


class LanguageServerCommand(Command):
    """Answer an editor that writes model files, by the Language Server Protocol on standard input and output.

    The editor starts it; docs/how_to/editors.md has the settings for several. Faults stand at their line while one
    types; completion, explanations, renaming, outline and formatting come with it. It needs the extra lsp.
    """

    def answer(self) -> Answer:
        from torsionnet.base.errors import MissingExtraError

        try:
            import pygls.lsp.server  # noqa: F401
        except ImportError as error:
            raise MissingExtraError(LSP_NEEDED) from error
        if sys.stdin is not None and sys.stdin.isatty():
            message("note", "an editor starts this command and talks with it; Ctrl-C ends it")
        from torsionnet.app.language_server.standard_streams import serve_standard_streams

        return Answer(exit_code=serve_standard_streams())


command = click_command("language-server", LanguageServerCommand)
