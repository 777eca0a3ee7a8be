"""Note on stderr on the memory that a command will take."""

from __future__ import annotations

from torsionnet.app.cli.terminal import message

LARGE_MEMORY = 1e9
"""Bytes of memory above which a command announces its need, since any computer has room for less."""


def note_memory(needed: float, advice: str) -> None:
    """Print a note on stderr if a command needs more than 1 GB, with advice on what takes less."""
    if needed > LARGE_MEMORY:
        message("note", f"takes about {needed / 1e9:.1f} GB of memory; {advice}")
