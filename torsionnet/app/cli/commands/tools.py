"""Commands that open the page or the editor's server, and explain the words behind messages."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterable
from typing import TYPE_CHECKING

import click

from torsionnet.app.cli.command import Answer, Command, ModelCommand
from torsionnet.app.cli.options import (
    STANDARD_INPUT,
    WrongUsage,
    argument,
    band_option,
    option,
    standard_input_text,
)
from torsionnet.app.cli.terminal import message, print_faults, print_line
from torsionnet.app.text.text_faults import GROUPS, FaultKind, fault_kind, fault_kinds

if TYPE_CHECKING:
    from torsionnet.app.explore import ExploreServer


# Command ``torsionnet explore``, which opens a page in the browser to play with a model.

TEMPLATE = "rig"
"""Kind of starting model that the page begins with where no model is named."""
TEMPLATE_NAME, TEMPLATE_FILE = "new rig", "model.yaml"
"""Name of that model, and of the file that the page offers to save."""

TEMPLATE_HEAD = """# A test rig to begin with: motor, torque meter, specimen, brake.
# ALL FIGURES ARE EXAMPLES: replace every one of them.
# Ctrl-Space completes, F8 goes to the next fault, Ctrl-. mends it, Ctrl-Z undoes. A mass-elastic table pasted over
# this text becomes a model.
"""
"""Comment above that model in the page."""


class ExploreCommand(ModelCommand):
    """A page in the browser to write a model and to play with it: text, sliders, responses, modes. Ctrl-C ends it.

    Without MODEL it begins with a small test rig. A model with errors is opened to be mended. The page writes to the
    file of the model, and to no other one, where its user says so.

    \b
    torsionnet explore
    torsionnet explore plant.yaml
    torsionnet explore amt_rig -c V --tf theta_1/T_T --overlay gear_V.csv --band 0.5 40
    torsionnet explore plant.yaml --over-speed "torque(coupling)" --measured tracked.csv
    """

    model: str = argument("[MODEL]", required=False, default="")
    pairs: tuple[str, ...] = option(
        "--tf",
        metavar="OUTPUT/INPUT",
        help='A response to offer, as "theta_1/T_M"; the first one is shown. Repeatable.',
    )
    over_speed: tuple[str, ...] = option(
        "--over-speed",
        metavar="OUTPUT",
        help='What excitations make of an output over speed, as "torque(coupling)"; shown at first. Repeatable.',
    )
    measured: str | None = option(
        "--measured",
        metavar="FILE",
        help="Orders of a test to lay over those of --over-speed: a file of torsionnet track, or CSV.",
    )
    band: tuple[float, float] | None = band_option("Frequencies in Hz.  [default: from the modes]")
    overlay: str | None = option(
        "--overlay", metavar="FILE", help="A measured response to lay over: CSV, NPZ, MAT, UFF58."
    )
    port: int = option("--port", type=click.IntRange(0, 65535), default=0, help="Default: any that is free.")
    no_browser: bool = option("--no-browser", help="Only print the address.")

    def answer(self) -> Answer:
        from torsionnet.app.explore.state import HIGHEST_FREQUENCY

        self.require_one("the page begins with one configuration: name one with -c; all of them are tabs of the page")
        if self.band and not 0 < self.band[0] < self.band[1] <= HIGHEST_FREQUENCY:
            given = f"{self.band[0]:g} {self.band[1]:g}"
            raise WrongUsage(
                f"--band needs 0 < LOW < HIGH <= {HIGHEST_FREQUENCY:g} Hz, got {given}", kind="unordered-rows"
            )
        from torsionnet.app.explore import ExploreServer, open_documents
        from torsionnet.app.explore.session import read_pair

        documents, faults = open_documents(
            self.model or TEMPLATE_FILE,
            "".join(self.configurations),
            dict(self.settings),
            [read_pair(pair) for pair in self.pairs],
            self.band,
            self.overlay,
            self._starting_text(),
            self.over_speed,
            self.measured,
            is_template=not self.model,
        )
        print_faults(faults)
        with ExploreServer(documents, self.port) as server:
            _serve(server, open_browser=not self.no_browser)
        return Answer()

    def _starting_text(self) -> str | None:
        """Text of a model without a file: the template, or standard input."""
        if not self.model:
            from torsionnet.app.cli.commands.model_files import starting_model

            text = starting_model(TEMPLATE, TEMPLATE_NAME)
            return TEMPLATE_HEAD + text[text.index("torsionnet: 1") :]  # without its commands for a terminal
        return standard_input_text() if self.model == STANDARD_INPUT else None


def _serve(server: ExploreServer, *, open_browser: bool) -> None:
    """Serve the page of the explorer to the browser until the user stops the command."""
    print_line(server.address)
    message("note", "the page is on this machine only; Ctrl-C ends it")
    if open_browser:
        import webbrowser

        # A text browser in this terminal would not return.
        threading.Thread(target=webbrowser.open, args=(server.address,), daemon=True).start()
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        message("note", "ended")


# Command ``torsionnet language-server``, which answers an editor that model files are written in.

LSP_NEEDED = 'the language server needs the package pygls: pip install "torsionnet[lsp]"'


class LanguageServerCommand(Command):
    """Answer an editor that writes model files, by the Language Server Protocol on standard input and output.

    The editor starts it; docs/how_to/editors.md has the settings for several. Faults stand at their line while one
    types; completion, explanations, renaming, outline and formatting come with it. It needs the extra lsp.

    \b
    torsionnet language-server
    """

    def answer(self) -> Answer:
        from torsionnet.base.errors import MissingExtraError

        try:
            import pygls.lsp.server  # noqa: F401
        except ImportError as error:
            raise MissingExtraError(LSP_NEEDED) from error
        if sys.stdin is not None and sys.stdin.isatty():
            message("note", "an editor starts this command and talks with it; Ctrl-C ends it")
        from torsionnet.app.language_server.model_server import serve_standard_streams

        return Answer(exit_code=serve_standard_streams())


# Command ``torsionnet explain``, which explains the word in brackets behind the message on a fault.


class ExplainCommand(Command):
    """Explain a kind of fault, the word in brackets behind a message: what it means, an example, and its mending.

    Without a word it lists all of them.

    \b
    torsionnet explain
    torsionnet explain unknown-node
    """

    kind: str | None = argument("[KIND]", required=False)

    def answer(self) -> Answer:
        shown = fault_kind(self.kind).explanation if self.kind else _listed(fault_kinds().values())
        return Answer(screen=shown.splitlines)


def _listed(kinds: Iterable[FaultKind]) -> str:
    """All kinds by group, each with its meaning."""
    groups = {group: [kind for kind in kinds if kind.group == group] for group in GROUPS}
    widest = max(len(kind.name) for kind in kinds)
    parts = [
        "\n".join([GROUPS[group], *(f"  {kind.name:{widest}}  {kind.means}" for kind in kinds_of_group)])
        for group, kinds_of_group in groups.items()
        if kinds_of_group
    ]
    return "\n\n".join(parts)
