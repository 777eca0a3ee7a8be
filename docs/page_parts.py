"""Markdown that several generated pages are made of."""

from __future__ import annotations


def table(headings: list[str], rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines) + "\n"


def prose(text: str) -> str:
    """Text in which stars are stars."""
    return text.replace("*", r"\*")


def code(text: object) -> str:
    return f"`{text}`"
