"""Messages about faults of YAML syntax, in the words of someone who edits a model file."""

from __future__ import annotations

import re
from collections.abc import Sequence

import yaml

_MEANINGS = (
    (
        "mapping values are not allowed",
        'a ":" is not expected here; check the indentation, and put text that holds ": " in quotes',
    ),
    (r"expected ',' or '}'", 'a "," between two entries or the closing "}" is missing{since}'),
    (r"expected ',' or '\]'", 'a "," between two values or the closing "]" is missing{since}'),
    ("unexpected end of stream", "a quote is opened here and never closed"),
    ("unexpected document separator", "a quote is opened here and never closed"),
    ("could not find expected ':'", 'a ":" is missing after this name'),
    ("expected (key|<block end>|'-' indicator)", "this does not fit the indentation of the lines above"),
    ("expected <?document start", "this stands outside of the model; check the indentation of the lines above"),
    (
        "(unknown escape|escape sequence|hexdecimal)",
        'a backslash in double quotes begins an escape; use single quotes or write "\\\\"',
    ),
    ("(undefined tag handle|tag|directive)", 'words that begin with "!" or "%" need quotes'),
    ("(anchor|alias)", 'text that begins with "&" or "*" needs quotes'),
    (
        "block (sequence|mapping) entries are not allowed|block sequence entries",
        'a list item ("- ") is not expected here',
    ),
    ("node content", "a value is missing or is not closed here"),
    ("indentation", "this does not fit the indentation of the lines above"),
)
"""Message to the user by regular expression of the problem that PyYAML reports."""


_UNSEPARATED = re.compile(r"(\s*)(\w+)(\s*|:)[{\[]")


def explain(error: yaml.MarkedYAMLError, lines: Sequence[str]) -> tuple[str, tuple[int, int]]:
    """Message about a fault of YAML syntax, and its line and column, from 0."""
    problem = error.problem or "this is no YAML"
    mark = _mark(error.problem_mark or error.context_mark, lines)
    character = lines[mark[0]][mark[1] : mark[1] + 1] if mark[0] < len(lines) else ""
    if "cannot start any token" in problem:
        return _no_start(character), mark
    since = ""
    unseparated = _UNSEPARATED.match(lines[mark[0]]) if "mapping values are not allowed" in problem else None
    if unseparated:
        return f'write "{unseparated[2]}: " with a colon and a blank after the name', (mark[0], unseparated.start(2))
    if error.context_mark is not None:
        opened = _mark(error.context_mark, lines)
        since = f"; it began at line {opened[0] + 1}, column {opened[1] + 1}"
        if "end of stream" in problem or "document separator" in problem:
            mark = opened
        elif "{since}" in _meaning(problem) and opened[0] < mark[0] and _is_whole(lines[opened[0]]):
            return (
                f'the "{lines[opened[0]][opened[1]]}" opened here is not closed, or a comma is missing after it',
                opened,
            )
    return _meaning(problem).replace("{since}", since), mark


def _meaning(problem: str) -> str:
    known = (meaning for pattern, meaning in _MEANINGS if re.search(pattern, problem))
    return next(known, f"this cannot be read as YAML: {problem}")


def _is_whole(line: str) -> bool:
    """Whether entries follow the opening bracket on its line, so that its end was meant to be there too."""
    return not line.rstrip().endswith(("{", "[", ","))


def _no_start(character: str) -> str:
    if character == "\t":
        return "a tab stands here; YAML is indented with spaces"
    return f'a value cannot begin with "{character}"; put it in quotes'


def _mark(mark: yaml.Mark | None, lines: Sequence[str]) -> tuple[int, int]:
    """Line and column, from 0, of a place that the YAML parser names.

    The end of the file is the end of the last line that is not empty.
    """
    if mark is None:
        return 0, 0
    line, column = mark.line, mark.column
    if line < len(lines) and (lines[line][column:].strip() or column):
        return line, column
    line = min(line, len(lines) - 1)
    while line > 0 and not lines[line].strip():
        line -= 1
    if line == mark.line:
        return line, column
    return line, max(len(lines[line].rstrip()) - 1, 0)
