"""Flow mappings, lists and quoted text that a person can read but YAML refuses, written so that YAML reads them."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

_CLOSING = {"{": "}", "[": "]"}
_PLAIN_IN_FLOW = re.compile(r"(?:[^,\[\]{}\n:#]|:(?![\s,\[\]{}]|$)|(?<!\s)#)+")
_PLAIN_IN_BLOCK = re.compile(r"(?:[^\n#]|(?<!\s)#)+")
_COLON = re.compile(r"\s*:(?=[\s,\[\]{}]|$)")
_UNREADABLE = re.compile(r"[@`%*!|>&?-]|\S*?:(?:\s|$)|.*?:(?:\s|$)")
"""Beginnings of a text that YAML does not read as text unless it is quoted."""


def mended(text: str) -> tuple[str, list[int]]:
    """Value of an entry with its brackets and quotes closed, and where in ``text`` each character and the end stood.

    Examples
    --------
    >>> mended("{type: spring, nodes: [a, b, stiffness: k_1")[0]
    '{type: spring, nodes: [a, b, ], stiffness: k_1}'
    >>> mended("{type: inertia node: a, inertia}}")[0]
    '{type: inertia, node: a, inertia}'
    """
    mending = _Mending(text)
    mending.run()
    return "".join(mending.out), [*mending.origins, len(text)]


@dataclass
class _Mending:
    """Walk through a value that writes it anew; ``state`` is "start" of an item, "value" after a colon, "done"."""

    text: str
    at: int = 0
    state: str = "value"
    stack: list[str] = field(default_factory=list)
    out: list[str] = field(default_factory=list)
    origins: list[int] = field(default_factory=list)

    def put(self, text: str, origin: int | None = None) -> None:
        """Write characters that stand in the text from ``origin`` on; without it they are new here."""
        for index, char in enumerate(text):
            self.out.append(char)
            self.origins.append(self.at if origin is None else origin + index)

    def run(self) -> None:
        text = self.text
        while self.at < len(text):
            char = text[self.at]
            if char.isspace():
                self.put(char, self.at)
                self.at += 1
            elif char == "#" and (self.at == 0 or text[self.at - 1].isspace()):
                end = text.find("\n", self.at)
                self.at = len(text) if end < 0 else end
            elif char in "{[" and (self.stack or self.state == "value"):
                self.separate()
                self.stack.append(char)
                self.put(char, self.at)
                self.at += 1
                self.state = "start"
            elif char in "}]":
                self.close(char)
            elif char == "," and self.stack:
                if self.state != "start":
                    self.put(char, self.at)
                self.at += 1
                self.state = "start"
            elif char in "\"'":
                self.quoted(char)
            else:
                self.plain()
        while self.stack:
            self.put(_CLOSING[self.stack.pop()])

    def separate(self) -> None:
        """Write the comma that is missing between two values."""
        if self.state == "done" and self.stack:
            self.put(", ")

    def close(self, char: str) -> None:
        if char in (_CLOSING[opened] for opened in self.stack):
            while (needed := _CLOSING[self.stack.pop()]) != char:
                self.put(needed)
            self.put(char, self.at)
            self.state = "done"
        self.at += 1

    def quoted(self, quote: str) -> None:
        start = self.at
        pattern = r'"((?:[^"\\\n]|\\[^\n])*)"' if quote == '"' else r"'((?:[^'\n]|'')*)'"
        whole = re.compile(pattern).match(self.text, start)
        if whole:
            content, self.at, after = whole[1], whole.end(), start + 1
            if quote == "'":
                content = content.replace("''", "'")
        else:
            end = re.compile(r"[,\]}\n]" if self.stack else r"\n").search(self.text, start + 1)
            after = start + 1
            stop = end.start() if end else len(self.text)
            content = self.text[after:stop].rstrip()
            self.at = after + len(content)
        if not self.start_of_key():
            self.separate()
        self.put("'", start)
        for index, char in enumerate(content):
            self.put("''" if char == "'" else char, min(after + index, self.at))
        self.put("'")
        self.state = "done"
        self.colon()

    def start_of_key(self) -> bool:
        """Whether a colon follows; what a key needs before it is then written."""
        if not self.stack or not _COLON.match(self.text, self.at):
            return False
        if self.stack[-1] == "[" and "{" in self.stack:
            self.stack.pop()
            self.put("]")
            self.state = "done"
        if self.state != "start":
            self.put(", ")
        return True

    def colon(self) -> None:
        found = _COLON.match(self.text, self.at) if self.stack else None
        if found:
            self.at = found.end()
            self.put(":" if self.text[self.at : self.at + 1].isspace() else ": ", self.at - 1)
            self.state = "value"

    def plain(self) -> None:
        found = (_PLAIN_IN_FLOW if self.stack else _PLAIN_IN_BLOCK).match(self.text, self.at)
        if found is None:  # a lone colon
            self.at += 1
            return
        start, words = self.at, found[0].rstrip()
        self.at += len(words)
        if self.stack and _COLON.match(self.text, self.at):
            value, blank, key = words.rpartition(" ")
            if blank and self.state == "value":
                self.scalar(value.rstrip(), start)
                self.put(", ", start + len(value.rstrip()))
                self.state = "start"
                words, start = key, start + len(value) + 1
            self.start_of_key()
            self.scalar(words, start)
            self.colon()
            return
        self.separate()
        self.scalar(words, start)
        self.state = "done"

    def scalar(self, words: str, start: int) -> None:
        if not _UNREADABLE.match(words) or (words[0] == "-" and words[1:2] not in ("", " ")):
            self.put(words, start)
        else:
            self.put("'", start)
            for index, char in enumerate(words):
                self.put("''" if char == "'" else char, start + index)
            self.put("'", start + len(words))
        self.state = "done"
