"""Place of a cursor inside a flow mapping or list, as ``{type: spring, nodes: [a,``."""

from __future__ import annotations

import re
from dataclasses import dataclass

_TOKEN = re.compile(
    r"""(?P<quoted>"(?:[^"\\\n]|\\[^\n])*"|'(?:[^'\n]|'')*')|(?P<open_quote>["'][^\n]*)|(?P<comment>(?<=\s)\#[^\n]*)"""
    r"""|(?P<mark>[{}\[\],])|(?P<colon>:(?=[\s,\[\]{}]|$))|(?P<newline>\n)|\s|(?P<word>(?:[^\s{}\[\],:]|:(?![\s,\[\]{}]|$))+)""",
    re.VERBOSE | re.DOTALL,
)


@dataclass(frozen=True)
class FlowPlace:
    """Place in a flow mapping or list: keys and indices around it, and where the word begun starts."""

    path: tuple[str | int, ...]
    is_key: bool
    start: int
    is_list_item: bool
    is_text: bool = False


@dataclass
class _Frame:
    """Bracket that is open, with the key or index at which its reading stands."""

    mark: str
    key: str | None = None
    index: int = 0
    start: int | None = None
    is_done: bool = False

    def step(self) -> str | int:
        return self.index if self.mark == "[" else self.key or ""


def flow_place(text: str, start: int, end: int) -> FlowPlace | None:
    """Place of offset ``end`` in the flow mapping or list that opens at ``start``, None where it is closed before.

    Examples
    --------
    >>> flow_place("{type: spring, nodes: [a, b", 0, 27)
    FlowPlace(path=('nodes', 1), is_key=False, start=26, is_list_item=True, is_text=False)
    """
    frames: list[_Frame] = []
    is_text = is_new_line = False
    for found in _TOKEN.finditer(text, start, end):
        kind, token = found.lastgroup, found[0]
        top = frames[-1] if frames else _Frame("")
        if kind == "mark" and token in "{[":
            frames.append(_Frame(token))
        elif kind == "mark" and token in "}]":
            wanted = "{" if token == "}" else "["
            if any(frame.mark == wanted for frame in frames):
                while frames.pop().mark != wanted:
                    pass
            if not frames:
                return None
            frames[-1].is_done = True
        elif kind == "mark":
            top.key, top.index, top.start, top.is_done = None, top.index + 1, None, False
        elif kind == "colon":
            _colon(frames, text, found.start())
        elif kind == "newline":
            is_new_line = True
            continue
        elif kind in ("quoted", "open_quote", "word"):
            if top.is_done or (is_new_line and top.start is not None and top.mark == "{"):
                # What follows a finished value is the next key, though the comma is missing.
                top.key, top.start, top.is_done = None, None, False
            top.start = found.start() if top.start is None else top.start
            top.is_done = kind == "quoted"
            is_text = kind == "open_quote"
        elif kind == "comment":
            is_text = found.end() == end
        is_new_line = False if kind else is_new_line
    if not frames:
        return None
    top = frames[-1]
    is_key = top.mark == "{" and top.key is None
    path = tuple(frame.step() for frame in (frames[:-1] if is_key else frames))
    word = end if top.start is None else top.start
    return FlowPlace(path, is_key, word, top.mark == "[", is_text or top.is_done)


def _colon(frames: list[_Frame], text: str, at: int) -> None:
    """Take the word before a colon as key; of two words without a comma the last."""
    top = frames[-1]
    if top.start is None:
        return
    words = text[top.start : at].strip()
    if top.mark == "[" and len(frames) > 1 and frames[-2].mark == "{":  # the list was not closed
        frames.pop()
        top = frames[-1]
    top.key = words.split()[-1].strip("\"'") if top.key is not None and words.split() else words.strip("\"'")
    top.start, top.is_done = None, False
