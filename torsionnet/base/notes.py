"""Notes on results, plain texts or texts with their severity and the channel that they are about."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
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


def stored_note(data: str | Mapping[str, str]) -> NoteOrText:
    """Note from plain data of a file; a warning without channel is a text that begins with that word.

    >>> stored_note("warning: too few lines").severity
    'warning'
    """
    if not isinstance(data, str):
        text = str(data["text"])
        severity: Literal["note", "warning"] = "warning" if data.get("severity") == "warning" else "note"
        return Note(text, severity, str(data.get("channel", ""))) if len(data) > 1 else text
    kind, _, rest = data.partition(": ")
    return warning(rest) if kind == "warning" else data


def note_data(remark: NoteOrText) -> str | dict[str, str]:
    """Note as plain data for a file: its text, or its fields where these do not follow from the text.

    >>> note_data(warning("too few lines")), note_data("warning: of a rig of this name")
    ('warning: too few lines', {'text': 'warning: of a rig of this name'})
    >>> note_data(Note("1 pulse missing", channel="warning"))
    {'text': '1 pulse missing', 'severity': 'note', 'channel': 'warning'}
    """
    text = str(remark)
    again = stored_note(text)
    if again in (remark, getattr(remark, "text", None)) and not getattr(remark, "channel", ""):
        return text
    return {"text": remark} if isinstance(remark, str) else asdict(remark)


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
