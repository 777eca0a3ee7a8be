"""Completion of a model text while it is written, from the specifications of its entries."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from torsionnet.app.text.cursor_context import CursorContext, cursor_context
from torsionnet.app.text.text_edits import TextSpan
from torsionnet.app.text.tolerant_reading import tolerant_data
from torsionnet.base.entries.declared import FORMAT_VERSION, KEY

if TYPE_CHECKING:
    from torsionnet.app.text.completion_places import CompletionOption

MOST_OPTIONS = 1000
"""Largest number of options of one completion, as nobody looks through more."""


@dataclass(frozen=True)
class Completion:
    """Option that a text can be completed with: ``insert`` takes the place of ``span``.

    Attributes
    ----------
    label : str
        What a list of options shows; the word begun is compared with it.
    kind : str
        One of entry, element type, node, parameter, unit, size, configuration, sensor, part and word.
    detail, documentation : str
        Unit or kind in a word, and what the option means in a sentence.
    """

    label: str
    kind: str
    detail: str
    documentation: str
    insert: str
    span: TextSpan


_REST = re.compile(r"[\w.]*(?:[*/^][\w.*/^]*)?")
"""Rest of a word behind the cursor, which an option replaces too."""
_NUMBER_BEGUN = re.compile(r"(?<![\w.])\.?\d[\w.]*\Z")
"""Number right before the cursor, also with letters that follow it without a blank."""
_KINDS = {"element": "word", "excitation": "word", "input": "sensor"}
"""Kind that a completion shows for things that have none of their own there."""


def completions(text: str, offset: int, file: str = "", folder: Path | None = None) -> list[Completion]:
    """Options for the word at an offset of a model text, the likeliest first; none in comments, quotes, free text.

    Nothing follows digits at once: whoever ends a number with Enter wants the number.

    Of the file at ``file`` the folder is that of ``folder`` or its own; catalogues and parts are read there.

    Examples
    --------
    >>> text = "elements:\\n  motor: {type: inertia, node: a, ine"
    >>> [option.insert for option in completions(text, len(text))]
    ['inertia: ']
    >>> text += "rtia: 0.078 "
    >>> completions(text, len(text))[0].label
    'kg*m^2'
    """
    context = cursor_context(text, offset)
    if context.is_text or _NUMBER_BEGUN.search(text, context.word.start, context.word.end):
        return []
    offset = context.word.end
    if context.path == (KEY,) and not context.is_key:
        version = str(FORMAT_VERSION)
        blank = " " if context.needs_blank else ""
        proposal = Completion(version, "word", "", "version of the file format", f"{blank}{version}", context.word)
        return [proposal] if version.startswith(text[context.word.start : offset]) else []
    if folder is None and file:
        folder = Path(file).parent
    return list(_fitting(text, offset, context, folder))[:MOST_OPTIONS]


def _fitting(text: str, offset: int, context: CursorContext, folder: Path | None) -> Iterator[Completion]:
    from torsionnet.app.text.completion_places import ModelNames, Writing, entry_place, holds_entries
    from torsionnet.app.text.completion_values import key_options, value_options

    word = text[context.word.start : offset]
    rest = _REST.match(text, offset) if word.strip() else None
    end = rest.end() if rest else offset
    # The word begun is no name yet: it would be offered as the name of a node.
    data = tolerant_data(text[: context.word.start] + text[end:])
    path = context.path
    scope = path[:2] if path[:1] == ("parts",) and len(path) > 2 else ()
    names = ModelNames(data if isinstance(data, dict) else {}, scope, folder)
    writing = Writing(text, offset, end, context, entry_place(data, path), names, folder)
    options: Iterable[CompletionOption] = key_options(writing) if context.is_key else ()
    is_list_below = context.is_key and not context.is_flow and bool(path) and not holds_entries(writing.place.spec)
    if not context.is_key or is_list_below:
        options = [*options, *value_options(writing, writing.place.spec)]
        if context.is_list_item and not word and not context.is_flow:
            options += key_options(writing)
    yield from _sorted(options, word, context, end)


def _sorted(options: Iterable[CompletionOption], word: str, context: CursorContext, end: int) -> Iterator[Completion]:
    """Completions that begin with the word, then those that hold it, without repetition."""
    seen: set[tuple[str, str]] = set()
    later: list[Completion] = []
    for option in options:
        begun = word[option.begin :].casefold()
        if option.begin > len(word) or begun not in option.label.casefold() or option[:2] in seen:
            continue
        seen.add(option[:2])
        insert = f" {option.insert}" if context.needs_blank and option.insert[:1] != "\n" else option.insert
        span = TextSpan(context.word.start + option.begin, end)
        kind = _KINDS.get(option.kind, option.kind)
        proposal = Completion(option.label, kind, option.detail, option.documentation, insert, span)
        if option.label.casefold().startswith(begun):
            yield proposal
        else:
            later.append(proposal)
    yield from later
