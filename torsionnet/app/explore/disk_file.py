"""Model file of the explore page on disk: its versions, and its storing as a whole."""

from __future__ import annotations

import codecs
import hashlib
import os
import re
import stat
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from difflib import SequenceMatcher, unified_diff
from pathlib import Path
from threading import Lock

from torsionnet.base.atomic import atomic_replacement
from torsionnet.base.errors import ModelError, TorsionnetError, UsageError
from torsionnet.model.files.library import MOST_BYTES, decode

# Byte order mark and line ends of a file, which its text in an editor lacks and the stored file has again.

_LINE = re.compile("([^\r\n]*)(\r\n|\r|\n|$)")
MOST_COMPARED = 4_000_000
"""Largest product of line counts of two texts that are compared line by line; it takes about a second."""


@dataclass(frozen=True)
class LineEnds:
    r"""Byte order mark and line ends of a file as it was read.

    Lines that stay keep their own ends, new ones get the usual end of the file.

    Examples
    --------
    >>> ends = LineEnds.of("a: 1\r\nb: 2\nc: 3\r\n", has_mark=False)
    >>> ends.usual, ends.given_back("a: 1\nnew: 0\nb: 2\n")
    ('\r\n', 'a: 1\r\nnew: 0\r\nb: 2\n')
    """

    has_mark: bool = False
    lines: tuple[tuple[str, str], ...] = ()
    usual: str = "\n"

    @classmethod
    def of(cls, text: str, *, has_mark: bool) -> LineEnds:
        """Line ends of a text that has been read from a file."""
        lines = _lines(text)
        counted = Counter(end for _, end in lines if end).most_common(1)
        return cls(has_mark, lines, counted[0][0] if counted else "\n")

    def given_back(self, text: str) -> str:
        """Text with the line ends of the file, from one that has none but line feeds."""
        if len({end for _, end in self.lines if end}) <= 1:
            return text if self.usual == "\n" else text.replace("\n", self.usual)
        now = text.split("\n")
        ends = dict(self._kept_line_ends(now))
        return "".join(f"{line}{ends.get(at, self.usual)}" for at, line in enumerate(now[:-1])) + now[-1]

    def bytes_of(self, text: str) -> bytes:
        """Bytes of the file for a text that has none but line feeds."""
        return (codecs.BOM_UTF8 if self.has_mark else b"") + self.given_back(text).encode()

    def _kept_line_ends(self, now: list[str]) -> list[tuple[int, str]]:
        """Index of each line that the file had before, and its line end there."""
        before = [line for line, _ in self.lines]
        same = 0
        while same < min(len(before), len(now)) and before[same] == now[same]:
            same += 1
        kept = [(at, self.lines[at][1]) for at in range(same)]
        rest, changed = before[same:], now[same:]
        if len(rest) * len(changed) <= MOST_COMPARED:
            for block in SequenceMatcher(None, rest, changed, autojunk=False).get_matching_blocks():
                kept += [(same + block.b + k, self.lines[same + block.a + k][1]) for k in range(block.size)]
        return [(at, end) for at, end in kept if end]


UNIX = LineEnds()
"""Line ends of a file that does not exist: line feeds, and no byte order mark."""


def plain_line_ends(text: str) -> str:
    r"""Text with line feeds as its only line ends.

    >>> plain_line_ends("a\r\nb\rc\n")
    'a\nb\nc\n'
    """
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _lines(text: str) -> tuple[tuple[str, str], ...]:
    lines = [(match[1], match[2]) for match in _LINE.finditer(text)]
    # An empty match stands at the end of every text.
    return tuple(lines[:-1] if len(lines) > 1 and not lines[-2][1] else lines)


LOOK_SECONDS = 0.2
"""Seconds between two looks at the file on disk while a page waits for changes of it."""
SETTLING_SECONDS = 0.03
"""Seconds for which a changed file has to stay the same before the page is told: some editors write in pieces."""
MOST_DIFFERENT_LINES = 4000
"""Largest number of lines of two texts together whose difference is shown; a longer one would take seconds."""
GONE = "gone"
"""Version of a file that does not exist."""
_NOFOLLOW = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)

Signature = tuple[int, ...]


@dataclass(frozen=True)
class DiskVersion:
    """Content of the file at one time; ``refusal`` says why it has no text."""

    name: str
    text: str = ""
    ends: LineEnds = UNIX
    refusal: str = ""


@dataclass(frozen=True)
class Stored:
    """Outcome of storing: the version on disk now, and the reason where nothing was written."""

    disk: DiskVersion
    reason: str = ""
    difference: str = ""


class DiskFile:
    """The one file that the page may store, found once when the page is started.

    Parameters
    ----------
    path : Path
        As the user named it; links are followed now and must not change later.
    """

    def __init__(self, path: Path) -> None:
        self._given = path.absolute()
        self.path = self._given.resolve(strict=True)
        self._storing = Lock()
        self._known: tuple[Signature, DiskVersion] | None = None

    @property
    def refusal(self) -> str:
        """Sentence on why the file cannot be stored, empty where it can."""
        if not self.path.is_file():
            return "this is no regular file; save the text as a file of its own"
        if not os.access(self.path, os.W_OK):
            return "the file is read-only; save the text as a file of its own"
        return ""

    def version(self) -> DiskVersion:
        """Content of the file now."""
        signature = self._signature()
        known = self._known
        if known is not None and signature == known[0]:
            return known[1]
        content = self._read()
        if signature is not None and signature == self._signature() and time.time_ns() - max(signature[:2]) > 10**8:
            # A younger file may change again within the resolution of its times.
            self._known = signature, content
        return content

    def changed(self, disk: str, ended: Callable[[], bool], seconds: float) -> DiskVersion | None:
        """Content of the file once it has another version than ``disk``, None where it keeps that version.

        A file that is gone has no other version: some editors remove a file just before they write it.
        """
        until = time.monotonic() + seconds
        while not ended():
            content = self.version()
            if content.name not in (disk, GONE):
                time.sleep(SETTLING_SECONDS)
                if self.version().name == content.name:
                    return content
            left = until - time.monotonic()
            if left <= 0:
                break
            time.sleep(min(LOOK_SECONDS, left))
        return None

    def store(self, text: str, disk: str) -> Stored:
        """Outcome of writing a text to the file, which must still have the version ``disk``."""
        with self._storing:
            before = self.version()
            reason = self._reason(before, disk)
            if reason:
                return Stored(before, reason, difference(before.text, text, self.path.name))
            content = before.ends.bytes_of(text)
            if len(content) > MOST_BYTES:
                return Stored(before, f"the text is too large: more than {MOST_BYTES // 1_000_000} MB")
            try:
                with atomic_replacement(self.path, follow_links=False) as temporary:
                    temporary.write_bytes(content)
                    now = self._read()
                    late = self._reason(now, disk)
                    if late:
                        raise _LateError(now, late)
            except _LateError as late_change:
                now = late_change.disk
                return Stored(now, str(late_change), difference(now.text, text, self.path.name))
            except OSError as error:
                return Stored(before, f"{self.path.name} cannot be written: {error.strerror or error}")
            return Stored(_version(content, self.path.name))

    def _reason(self, content: DiskVersion, disk: str) -> str:
        if not self._leads_here():
            return "the name of the file leads elsewhere now; nothing is written: start torsionnet explore again"
        if content.name == disk:
            return "" if disk == GONE else self.refusal
        if content.name == GONE:
            return "the file is gone; store again to write it anew, or save the text as a file of its own"
        return "the file has been changed by another program since the page read it"

    def _leads_here(self) -> bool:
        """Whether the name of the start still leads to the file of the start, and to no link in its place."""
        try:
            return self._given.resolve() == self.path
        except (OSError, RuntimeError):  # the latter of links that lead in a circle, up to Python 3.12
            return False

    def _signature(self) -> Signature | None:
        try:
            status = self.path.stat(follow_symlinks=False)
        except OSError:
            return None
        return status.st_mtime_ns, status.st_ctime_ns, status.st_size, status.st_ino, status.st_mode

    def _read(self) -> DiskVersion:
        try:
            handle = os.open(self.path, os.O_RDONLY | _NOFOLLOW)
        except FileNotFoundError:
            return DiskVersion(GONE)
        except OSError as error:
            return DiskVersion("unreadable", refusal=f"{self.path.name} cannot be read: {error.strerror or error}")
        with os.fdopen(handle, "rb") as stream:
            if not stat.S_ISREG(os.fstat(handle).st_mode):
                return DiskVersion("unreadable", refusal=f"{self.path.name} is no regular file")
            return _version(stream.read(MOST_BYTES + 1), self.path.name)


class _LateError(TorsionnetError):
    """Change of the file between the first look at it and its replacement."""

    def __init__(self, disk: DiskVersion, reason: str) -> None:
        self.disk = disk
        super().__init__(reason)


def disk_file(path: Path) -> DiskFile:
    """File on disk of a path; UsageError where there is none."""
    try:
        return DiskFile(path)
    except (OSError, RuntimeError) as error:
        raise UsageError(f"{path} cannot be read: {error}", kind="unreadable-file") from None


def _version(content: bytes, name: str) -> DiskVersion:
    """Version of a file with this content.

    Its name is that of the content alone: a file whose time alone has changed has nothing to be told of.
    """
    version = f"{len(content)}-{hashlib.sha256(content).hexdigest()[:32]}"
    try:
        text = decode(content, name)
    except ModelError as error:
        return DiskVersion(version, refusal=error.faults[0].message)
    ends = LineEnds.of(text, has_mark=content.startswith(codecs.BOM_UTF8))
    return DiskVersion(version, plain_line_ends(text), ends)


def difference(before: str, after: str, name: str) -> str:
    """Difference of two texts of a file in the unified form, from the one on disk to the one on the page."""
    old, new = before.splitlines(keepends=True), after.splitlines(keepends=True)
    if len(old) + len(new) > MOST_DIFFERENT_LINES:
        return f"(of {len(old)} lines on disk and {len(new)} lines on the page the differences are not shown)\n"
    lines = unified_diff(old, new, f"{name} on disk", f"{name} on the page")
    return "".join(line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines)
