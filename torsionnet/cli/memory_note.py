"""Note on stderr on the memory that a command will take."""

from __future__ import annotations

from torsionnet.cli.terminal import message

LARGE_MEMORY = 1e9
"""Bytes from which the memory of a command is announced: below, any computer has it."""


def note_memory(needed: float, advice: str) -> None:
    """Print a note if ``needed`` bytes are more than 1 GB, with advice on what takes less."""
    if needed > LARGE_MEMORY:
        message("note", f"takes about {needed / 1e9:.1f} GB of memory; {advice}")
