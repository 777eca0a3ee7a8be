"""Text in one tab of the explore page, with its faults and its last sound session."""

from __future__ import annotations

import time
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from threading import Lock
from typing import Any

from torsionnet.app.explore.newest_turn import NewestTurn
from torsionnet.app.explore.offset_counting import OffsetCounting
from torsionnet.app.explore.session import Session
from torsionnet.app.explore.session_remaking import SessionOptions, remade_session
from torsionnet.app.text.text_edits import TextLines, TextSpan
from torsionnet.app.text.text_faults import LocatedFault, stretched_faults, text_faults
from torsionnet.app.text.unstable_configurations import unstable_configurations
from torsionnet.base.errors import Fault, TorsionnetError
from torsionnet.base.registers import RecentResults
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.files.reader import read_text

Answer = dict[str, Any]

SUPERSEDED: Answer = {"superseded": True}
"""Answer to a request in whose place a newer one was taken up."""
MOST_FAULTS = 1000
"""Largest number of faults of a text that the page shows; more would hold up the browser."""
ALIVE_SECONDS = 5.0
"""Seconds without any request after which a tab counts as closed."""


@dataclass(frozen=True)
class SoundText:
    """Session of a sound text with the revision of that text, and the data that describe its model."""

    session: Session
    revision: int
    described: Answer

    @cached_property
    def for_pictures(self) -> Session:
        """Session of the same model for schematic and modes, which share no results with responses under way."""
        base = copy(self.session.base)
        return replace(self.session, base=base, pictures=RecentResults(), _chosen={})


@dataclass(frozen=True)
class Examined:
    """Text that has been examined, with its faults, None until they are asked for, and the last sound text."""

    revision: int
    text: str
    faults: list[LocatedFault] | None
    sound: SoundText | None
    is_sound: bool

    def to_data(self) -> Answer:
        """Faults as JSON data, and what describes the model if this very text is sound."""
        model = self.sound.described | {"revision": self.revision} if self.sound and self.is_sound else None
        faults = faults_data(self.text, self.faults or [])
        return {"revision": self.revision, "sound": model is not None, "faults": faults, "model": model}

    def refused(self) -> Answer:
        """Reasons why there is no model, as JSON data."""
        said = [one.fault.text for one in self.faults or [] if one.fault.severity == "error"]
        return {"refused": said or ["the text is no sound model yet"], "revision": self.revision}


@dataclass(frozen=True)
class Draft:
    """Text that is stored nowhere, with the version of the file that it began from and when its tab last asked."""

    text: str
    revision: int
    disk: str
    base_text: str
    last_used: float

    @property
    def is_left(self) -> bool:
        """Whether its tab has not asked for anything for so long that it counts as closed."""
        return time.monotonic() - self.last_used >= ALIVE_SECONDS


class Document:
    """Text of one tab with its revision, its faults and its last sound session.

    Faults, pictures and other calculations have a queue each, so that the first two never wait for a response under
    way. A session is only used by one calculation at a time: a drivetrain keeps results while it calculates them.

    Parameters
    ----------
    options : SessionOptions
    text : str
    disk : str
        Version of the file that holds the text, empty where no file can be stored.
    start : Session, optional
        The session of this text, where there is one already; no other document may have it.
    """

    def __init__(self, options: SessionOptions, text: str, disk: str = "", start: Session | None = None) -> None:
        self.options = options
        self.text, self.revision = text, 0
        self.base_text, self.disk = text, disk
        self.is_handed_on = False
        self.polls = 0
        self.poll_count = 0
        self.last_used = time.monotonic()
        self._examined: Examined | None = None
        self._examining, self._changing = Lock(), Lock()
        self._texts: NewestTurn[Answer] = NewestTurn()
        self._calculations: NewestTurn[Answer] = NewestTurn()
        self._pictures: NewestTurn[Answer] = NewestTurn()
        if start is not None:
            self._examined = Examined(0, text, None, SoundText(start, 0, start.describe()), is_sound=True)

    @property
    def is_alive(self) -> bool:
        """Whether a tab of the browser still shows the text."""
        return self.polls > 0 or time.monotonic() - self.last_used < ALIVE_SECONDS

    @property
    def draft(self) -> Draft | None:
        """Unsaved text, None where it is that of the file or another document shows it now."""
        if self.is_handed_on or self.text == self.base_text:
            return None
        return Draft(self.text, self.revision, self.disk, self.base_text, self.last_used)

    def take_over(self, draft: Draft) -> None:
        """Go on with the unsaved text of a closed tab."""
        with self._changing:
            self.text, self.revision, self.disk, self.base_text = (
                draft.text,
                draft.revision,
                draft.disk,
                draft.base_text,
            )

    def is_stored(self, text: str, disk: str) -> None:
        """Remember that the file holds a text now, in the version given."""
        with self._changing:
            self.base_text, self.disk = text, disk

    def change(self, revision: int, text: str) -> Answer:
        """Faults of a new text as JSON data, and what describes its model if it is sound."""
        with self._changing:
            if revision < self.revision:
                return SUPERSEDED
            self.text, self.revision, self.is_handed_on = text, revision, False
        return self.in_turn("text", lambda: self.examined(with_faults=True).to_data())

    def in_turn(self, kind: str, examine: Callable[[], Answer]) -> Answer:
        """Answer of a service on texts once it has its turn."""
        found = self._texts.take(kind, examine)
        return SUPERSEDED if found is None else found

    def calculated(self, kind: str, calculate: Callable[[Session], Answer]) -> Answer:
        """Answer of a calculation on the last sound text once it has its turn, with the revision of that text."""
        found = self._calculations.take(kind, lambda: self._with_revision(calculate))
        return SUPERSEDED if found is None else found

    def drawn(self, kind: str, draw: Callable[[Session], Answer]) -> Answer:
        """Answer with a picture of the last sound text once it has its turn, with the revision of that text."""
        found = self._pictures.take(kind, lambda: self._with_revision(draw, for_pictures=True))
        return SUPERSEDED if found is None else found

    def described(self) -> Answer:
        """Data that describe the model of the last sound text."""
        found = self.examined()
        return found.refused() if found.sound is None else found.sound.described | {"revision": found.sound.revision}

    def examined(self, *, with_faults: bool = False) -> Examined:
        """Findings on the text of now; an answer is made of it as a whole, as the text changes meanwhile."""
        with self._examining:
            with self._changing:
                revision, text = self.revision, self.text
            last = self._examined
            if last is None or (last.revision, last.text) != (revision, text):
                last = self._examine(revision, text, last.sound if last else None)
            if with_faults and last.faults is None:  # the text of the start was read before it had this document
                last = replace(last, faults=text_faults(text, str(self.options.path), self.options.folder))
            self._examined = last
            return last

    def _with_revision(self, calculate: Callable[[Session], Answer], *, for_pictures: bool = False) -> Answer:
        found = self.examined()
        if found.sound is None:
            return found.refused()
        session = found.sound.for_pictures if for_pictures else found.sound.session
        return calculate(session) | {"revision": found.sound.revision}

    def _examine(self, revision: int, text: str, before: SoundText | None) -> Examined:
        file, folder = str(self.options.path), self.options.folder
        definition, found = read_text(text, file, folder, unstable_configurations)
        faults = stretched_faults(text, found, file, folder)
        if definition is None:
            return Examined(revision, text, faults, before, is_sound=False)
        try:
            session = remade_session(Drivetrain.from_definition(definition, found), text, self.options)
            sound = SoundText(session, revision, session.describe())
        except TorsionnetError as error:
            faults = [*faults, LocatedFault(Fault(str(error)), TextSpan(0, 0))]
            return Examined(revision, text, faults, before, is_sound=False)
        return Examined(revision, text, faults, sound, is_sound=True)


def faults_data(text: str, faults: list[LocatedFault]) -> list[Answer]:
    """Faults of a text as JSON data, with offsets as browsers count them."""
    counting, lines = OffsetCounting(text), TextLines(text)
    found = []
    rest = len(faults) - MOST_FAULTS
    more = [LocatedFault(Fault(f"{rest} more faults are not shown", severity="note"), TextSpan(0, 0))]
    for one in [*faults[:MOST_FAULTS], *(more if rest > 0 else ())]:
        line, column = lines.place(one.span.start)
        fixes = [{"title": fix.title, "edits": counting.edits(fix.edits)} for fix in one.fixes]
        said = {"severity": one.fault.severity, "message": one.fault.text, "line": line + 1, "column": column + 1}
        found.append(said | counting.span(one.span) | {"fixes": fixes})
    return found
