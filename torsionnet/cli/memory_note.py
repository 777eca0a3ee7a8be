"""What a command takes in memory, said before it starts."""

from __future__ import annotations

from torsionnet.cli.terminal import message

WORTH_TELLING = 1e9


def announce(needed: float, advice: str) -> None:
    """A note where a command takes more than 1 GB, with what would take less."""
    if needed > WORTH_TELLING:
        message("note", f"takes about {needed / 1e9:.1f} GB of memory; {advice}")
