"""Notes on results, plain texts or texts with their severity and the channel that they are about."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias


@dataclass(frozen=True)
class Note:
    """Note on a result with its severity and the channel that it is about.

    Examples
    --------
    >>> note = Note("1 pulse missing", "warning", channel="fly")
    >>> str(note), "missing" in note
    ('warning: fly: 1 pulse missing', True)
    """

    text: str
    severity: Literal["note", "warning"] = "note"
    channel: str = ""

    def __str__(self) -> str:
        severity = "" if self.severity == "note" else f"{self.severity}: "
        return f"{severity}{self.named}"

    def __contains__(self, words: str) -> bool:
        return words in str(self)

    @property
    def named(self) -> str:
        """Text of the note behind the name of its channel."""
        return f"{self.channel}: {self.text}" if self.channel else self.text


NoteOrText: TypeAlias = str | Note
"""Note on a result; a plain text is one without severity and channel."""


def warning(text: str) -> Note:
    """Note that is to be heeded."""
    return Note(text, "warning")


def stored_note(text: str) -> NoteOrText:
    """Note from its text in a file, where a warning begins with that word.

    >>> stored_note("warning: too few lines").severity
    'warning'
    """
    kind, _, rest = text.partition(": ")
    return warning(rest) if kind == "warning" else text


def about_channel(remark: NoteOrText, channel: str) -> Note:
    """Note that is about a channel.

    >>> str(about_channel("1 pulse missing", "fly"))
    'fly: 1 pulse missing'
    """
    return Note(remark, channel=channel) if isinstance(remark, str) else replace(remark, channel=channel)


def is_warning(remark: NoteOrText) -> bool:
    """Whether a note on a result is to be heeded.

    >>> is_warning(Note("too few lines", "warning")), is_warning("warning: too few lines")
    (True, False)
    """
    return isinstance(remark, Note) and remark.severity == "warning"
