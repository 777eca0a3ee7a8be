"""Markdown of tables and texts for generated pages."""

from __future__ import annotations


def table(headings: list[str], rows: list[list[str]]) -> str:
    """Markdown of a table."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines) + "\n"


def prose(text: str) -> str:
    """Markdown of a text with its stars escaped."""
    return text.replace("*", r"\*")


def code(text: object) -> str:
    return f"`{text}`"
