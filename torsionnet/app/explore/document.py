"""Text in one tab of the explore page, with its faults and its last sound session."""

from __future__ import annotations

import re
import time
from bisect import bisect_left
from collections.abc import Callable, Iterable, Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from threading import Condition, Lock
from typing import Any, Generic, TypeVar

from torsionnet.app.explore.over_speed import runs
from torsionnet.app.explore.session import ResponseChoice, Session, opening_state
from torsionnet.app.explore.sliders import point_settings
from torsionnet.app.text.text_edits import TextEdit, TextLines, TextSpan
from torsionnet.app.text.text_faults import LocatedFault, stretched_faults, text_faults
from torsionnet.app.text.unstable_configurations import unstable_configurations
from torsionnet.base.errors import Fault, TorsionnetError
from torsionnet.base.registers import RecentResults
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.model.configurations import parse_choice
from torsionnet.model.files.reader import read_text

# Sessions of the explore page made anew from a text, with what its command line asked for where that still fits.


@dataclass(frozen=True)
class SessionOptions:
    """Options of the command line that began the page, beside the model.

    Attributes
    ----------
    model : str
        Name or path on the command line, for commands that the page shows.
    path : Path
        Of the model file; it need not exist.
    folder : Path, optional
        Where files that the text names lie; None: it can name none.
    configuration : str
    settings : mapping
        Parameter -> value.
    pairs : tuple of ResponseChoice
    band : (float, float), optional
        Hz; default: what suits the modes, anew for each text.
    overlay : FrequencyResponse, optional
    overlay_name : str
    over_speed : tuple of str
    measured : Path, optional
        A file of measured orders.
    opened : Session, optional
        As the page was opened; the same text begins in the same state.
    """

    model: str
    path: Path
    folder: Path | None = None
    configuration: str = ""
    settings: Mapping[str, Any] = field(default_factory=dict)
    pairs: tuple[ResponseChoice, ...] = ()
    band: tuple[float, float] | None = None
    overlay: FrequencyResponse | None = None
    overlay_name: str = ""
    over_speed: tuple[str, ...] = ()
    measured: Path | None = None
    opened: Session | None = None

    @classmethod
    def of(cls, session: Session) -> SessionOptions:
        """Options with which a session was opened, as far as it shows them."""
        choice = ",".join(f"{axis}={alternative}" for axis, alternative in session.start.choice.items())
        folder = session.folder
        return cls(
            session.model, Path(session.file) if folder is None else folder / session.file, folder, choice,
            {**session.point, **session.start.values}, session.pairs, session.start.band, session.overlay,
            session.overlay_name, session.over_speed, session.measured, session,
        )  # fmt: skip


def remade_session(base: Drivetrain, text: str, options: SessionOptions) -> Session:
    """Session of a sound text; options that do not fit this model are left out without a word."""
    point, base = _operating_point(base, options.settings)
    choice = _choice(base, options.configuration)
    values = _values(base, choice, {name: value for name, value in options.settings.items() if name not in point})
    pairs = tuple(pair for pair in options.pairs if _is_known(base, pair))
    over_speed = options.over_speed if runs(base) else ()
    start = opening_state(base, choice, values, pairs, options.band or (0.0, 0.0), options.overlay, over_speed)
    if options.opened is not None and options.opened.text == text:
        start = options.opened.start
    return Session(
        options.model, options.path.name, text, base, start, pairs, over_speed, options.overlay, options.overlay_name,
        options.folder, options.measured if over_speed else None, point,
    )  # fmt: skip


def _operating_point(base: Drivetrain, settings: Mapping[str, Any]) -> tuple[dict[str, Any], Drivetrain]:
    """Operating point that settings give, and the drivetrain in it."""
    try:
        point = dict(point_settings(settings, base))
        return point, base.configured(**point) if point else base
    except TorsionnetError:
        return {}, base


def _choice(base: Drivetrain, configuration: str) -> dict[str, str]:
    try:
        return dict(parse_choice(configuration, base.definition.configurations)) if configuration else {}
    except TorsionnetError:
        return {}


def _values(base: Drivetrain, choice: Mapping[str, str], values: Mapping[str, Any]) -> dict[str, Any]:
    """Values of parameters that the model has and takes, each beside those before it."""
    name = ",".join(f"{axis}={alternative}" for axis, alternative in choice.items())
    kept: dict[str, Any] = {}
    for parameter, value in values.items():
        try:
            base.configured(name, **kept, **{parameter: value})
        except TorsionnetError:
            continue
        kept[parameter] = value
    return kept


def _is_known(base: Drivetrain, pair: ResponseChoice) -> bool:
    """Whether a response can be asked for; torques in elements as ``torque(shaft)`` are tried when they are shown."""
    outputs, inputs = {*base.sensors, *base.nodes}, {*base.inputs, *base.sensors, *base.nodes}
    return all("(" in name or name in known for name, known in ((pair.output, outputs), (pair.input, inputs)))


# Turns of requests that wait for one another, of which only the newest of each kind is worth answering.

Result = TypeVar("Result")


class NewestTurn(Generic[Result]):
    """Queue of calculations that run one at a time; of several of a kind that wait, only the newest has its turn.

    Kinds keep their places in the queue when a newer request of theirs comes, so that none starves.

    Examples
    --------
    >>> NewestTurn().take("answer", lambda: 6.268)
    6.268
    """

    def __init__(self) -> None:
        self._changed = Condition()
        self._waiting: dict[str, int] = {}
        self._count = 0
        self._is_busy = False

    def take(self, kind: str, calculate: Callable[[], Result]) -> Result | None:
        """Result of a calculation once it has its turn, None where a newer one of its kind took its place."""
        with self._changed:
            self._count += 1
            own = self._waiting[kind] = self._count
            self._changed.notify_all()
            while self._waiting.get(kind) == own and (self._is_busy or next(iter(self._waiting)) != kind):
                self._changed.wait()
            if self._waiting.get(kind) != own:
                return None
            del self._waiting[kind]
            self._is_busy = True
        try:
            return calculate()
        finally:
            with self._changed:
                self._is_busy = False
                self._changed.notify_all()


# Offsets of a text between characters and the counting of browsers.

_WIDE = re.compile("[\U00010000-\U0010ffff]")
"""Expression of a character that browsers count as two."""


class OffsetCounting:
    """Conversion of the offsets of one text.

    Examples
    --------
    >>> counting = OffsetCounting("\\U0001d70b: k")
    >>> counting.to_page(1), counting.from_page(2), counting.from_page(99)
    (2, 1, 4)
    """

    def __init__(self, text: str) -> None:
        self._length = len(text)
        self._wide = [] if text.isascii() else [wide.start() for wide in _WIDE.finditer(text)]
        self._wide_on_page = [place + before for before, place in enumerate(self._wide)]

    def to_page(self, offset: int) -> int:
        """Offset as the page counts it."""
        return offset + bisect_left(self._wide, offset)

    def from_page(self, offset: int) -> int:
        """Offset in characters, at most the length of the text, of one that the page counted."""
        return min(offset - bisect_left(self._wide_on_page, offset - 1), self._length)

    def span(self, span: TextSpan) -> dict[str, Any]:
        """Ends of a stretch as JSON data."""
        return {"from": self.to_page(span.start), "to": self.to_page(span.end)}

    def edits(self, edits: Iterable[TextEdit]) -> list[dict[str, Any]]:
        """Edits as JSON data."""
        return [self.span(edit.span) | {"text": edit.text} for edit in edits]


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
        said = [located.fault.text for located in self.faults or [] if located.fault.severity == "error"]
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
        answer = self._texts.take(kind, examine)
        return SUPERSEDED if answer is None else answer

    def calculated(self, kind: str, calculate: Callable[[Session], Answer]) -> Answer:
        """Answer of a calculation on the last sound text once it has its turn, with the revision of that text."""
        answer = self._calculations.take(kind, lambda: self._with_revision(calculate))
        return SUPERSEDED if answer is None else answer

    def drawn(self, kind: str, draw: Callable[[Session], Answer]) -> Answer:
        """Answer with a picture of the last sound text once it has its turn, with the revision of that text."""
        answer = self._pictures.take(kind, lambda: self._with_revision(draw, for_pictures=True))
        return SUPERSEDED if answer is None else answer

    def described(self) -> Answer:
        """Data that describe the model of the last sound text."""
        examined = self.examined()
        if examined.sound is None:
            return examined.refused()
        return examined.sound.described | {"revision": examined.sound.revision}

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
        examined = self.examined()
        if examined.sound is None:
            return examined.refused()
        session = examined.sound.for_pictures if for_pictures else examined.sound.session
        return calculate(session) | {"revision": examined.sound.revision}

    def _examine(self, revision: int, text: str, before: SoundText | None) -> Examined:
        file, folder = str(self.options.path), self.options.folder
        definition, findings = read_text(text, file, folder, unstable_configurations)
        faults = stretched_faults(text, findings, file, folder)
        if definition is None:
            return Examined(revision, text, faults, before, is_sound=False)
        try:
            session = remade_session(Drivetrain.from_definition(definition, findings), text, self.options)
            sound = SoundText(session, revision, session.describe())
        except TorsionnetError as error:
            faults = [*faults, LocatedFault(Fault(str(error), kind=error.kind), TextSpan(0, 0))]
            return Examined(revision, text, faults, before, is_sound=False)
        return Examined(revision, text, faults, sound, is_sound=True)


def faults_data(text: str, faults: list[LocatedFault]) -> list[Answer]:
    """Faults of a text as JSON data, with offsets as browsers count them."""
    counting, lines = OffsetCounting(text), TextLines(text)
    data = []
    rest = len(faults) - MOST_FAULTS
    more = [LocatedFault(Fault(f"{rest} more faults are not shown", severity="note"), TextSpan(0, 0))]
    for located in [*faults[:MOST_FAULTS], *(more if rest > 0 else ())]:
        line, column = lines.place(located.span.start)
        fixes = [{"title": fix.title, "edits": counting.edits(fix.edits)} for fix in located.fixes]
        said = {"severity": located.fault.severity, "kind": located.fault.kind, "message": located.fault.text}
        said |= {"line": line + 1, "column": column + 1}
        data.append(said | counting.span(located.span) | {"fixes": fixes})
    return data
