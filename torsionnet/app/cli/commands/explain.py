"""Command ``torsionnet explain``, which explains the word in brackets behind the message on a fault."""

from __future__ import annotations

from collections.abc import Iterable

from torsionnet.app.cli.command import Answer, Command
from torsionnet.app.cli.options import argument
from torsionnet.app.text.fault_table import GROUPS, FaultKind, fault_kind, fault_kinds


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
    groups = {group: [one for one in kinds if one.group == group] for group in GROUPS}
    widest = max(len(one.name) for one in kinds)
    parts = [
        "\n".join([GROUPS[group], *(f"  {one.name:{widest}}  {one.means}" for one in found)])
        for group, found in groups.items()
        if found
    ]
    return "\n\n".join(parts)
