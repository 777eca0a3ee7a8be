"""Texts of the tabs of an explore page, with the drafts of closed tabs and the model file."""

from __future__ import annotations

import os
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from threading import Event, Lock

from torsionnet.app.explore.disk_file import GONE, DiskFile, disk_file, plain_line_ends
from torsionnet.app.explore.document import SUPERSEDED, Answer, Document, Draft, SessionOptions
from torsionnet.app.explore.session import ResponseChoice, Session, open_session, read_overlay
from torsionnet.base.errors import Fault
from torsionnet.model.files.library import decode, library_models
from torsionnet.model.files.reader import find_model, read_text

MOST_DOCUMENTS = 16
"""Largest number of texts kept with their models; each takes as much memory as a session."""
MOST_DRAFT_BYTES = 4_000_000
"""Largest size together of the drafts that are kept of texts whose document has gone."""
POLL_SECONDS = 20.0
"""Longest time in seconds that a request for changes of the file waits for one."""
MOST_POLLS = 3
"""Largest number of requests for changes that wait at a time: a browser has six connections for all of its tabs."""
RETRY_SECONDS = 2
"""Seconds that a page should wait before it asks for changes again where it was answered at once."""


@dataclass(frozen=True)
class TextSource:
    """Text that the page begins with, and the file that it comes from.

    Attributes
    ----------
    text : str
    file : str
        Name of the file.
    shown : str
        Path or name that the user gave.
    disk : DiskFile, optional
        The file that may be stored.
    why_not : str
        Sentence on why nothing can be stored and what to do, where that is so.
    is_template : bool
    """

    text: str
    file: str
    shown: str
    disk: DiskFile | None = None
    why_not: str = ""
    is_template: bool = False


class Documents:
    """Texts of the page by the name that a tab gives itself.

    Parameters
    ----------
    options : SessionOptions
    source : TextSource
    session : Session, optional
        Of the source's text, where that is sound.
    """

    def __init__(self, options: SessionOptions, source: TextSource, session: Session | None = None) -> None:
        self.options, self.source = options, source
        self.session = session
        self.ended = Event()
        self._spare = session
        self._documents: OrderedDict[str, Document] = OrderedDict()
        self._drafts: OrderedDict[str, Draft] = OrderedDict()
        self._lock = Lock()
        self._polls = 0

    @classmethod
    def of(cls, session: Session) -> Documents:
        """Documents of a session, without a file to store."""
        why_not = "this page was started without a file; save the text as a file of its own"
        source = TextSource(plain_line_ends(session.text), session.file, session.model, None, why_not)
        return cls(SessionOptions.of(session), source, session)

    def named(self, name: str) -> Document:
        """Document of a tab, made with the text of the file, or with its own draft, where there is none yet."""
        with self._lock:
            document = self._documents.get(name)
            if document is None:
                document = self._new(name)
            document.last_used = time.monotonic()
            self._documents.move_to_end(name)
            return document

    def open(self, name: str) -> Answer:
        """Text of a tab as JSON data: its own, the draft of a closed tab, or that of the file."""
        is_new = name not in self._documents
        document = self.named(name)
        if is_new and document.draft is None:
            draft = self._draft_of_closed(name)
            if draft is not None:
                document.take_over(draft)
        why_not = self.why_not()
        return {
            "text": document.text,
            "revision": document.revision,
            "file": self.source.file,
            "path_shown": self.source.shown,
            "can_save": not why_not,
            "save_hint": why_not,
            "is_template": self.source.is_template,
            "disk": document.disk,
            "draft": document.draft is not None,
        }

    def why_not(self) -> str:
        """Sentence on why nothing can be stored, empty where it can."""
        return self.source.why_not if self.source.disk is None else self.source.disk.refusal

    def store(self, document: Document, text: str, disk: str) -> Answer:
        """Outcome of storing a text as JSON data."""
        file = self.source.disk
        if file is None:
            return {"stored": False, "reason": self.source.why_not, "difference": "", "text": None, "disk": ""}
        done = file.store(text, disk)
        if not done.reason:
            document.is_stored(text, done.disk.name)
            return {"stored": True, "disk": done.disk.name}
        theirs = None if done.disk.refusal or done.disk.name == GONE else done.disk.text
        shown = {"difference": done.difference, "text": theirs, "disk": done.disk.name}
        return {"stored": False, "reason": done.reason} | shown

    def changes(self, document: Document, disk: str, is_closed: Callable[[], bool]) -> Answer:
        """Content of the file as JSON data once it has another version than ``disk``, or what is left of it.

        Waits at most :data:`POLL_SECONDS`, and not at all where too many tabs wait already.
        """
        file = self.source.disk
        with self._lock:
            document.poll_count += 1
            own = document.poll_count
            waits = self._polls < MOST_POLLS
            self._polls += 1
            document.polls += 1

        def is_over() -> bool:
            return self.ended.is_set() or document.poll_count != own or is_closed()

        try:
            if file is None:
                self._wait(is_over, POLL_SECONDS if waits else 0.0)
                content = None
            else:
                content = file.changed(disk, is_over, POLL_SECONDS if waits else 0.0)
        finally:
            with self._lock:
                self._polls -= 1
                document.polls -= 1
                document.last_used = time.monotonic()
        if document.poll_count != own:
            return SUPERSEDED
        if content is None:
            return {"disk": disk} | ({} if waits else {"wait_s": RETRY_SECONDS})
        return {"disk": content.name} | ({"refused": [content.refusal]} if content.refusal else {"text": content.text})

    def _wait(self, is_over: Callable[[], bool], seconds: float) -> None:
        until = time.monotonic() + seconds
        while not is_over() and time.monotonic() < until:
            self.ended.wait(min(0.2, seconds))

    def _new(self, name: str) -> Document:
        """New document, for which the one longest unused has to go where there are too many."""
        text, disk = self.source.text, ""
        if self.source.disk is not None:
            version = self.source.disk.version()
            disk = version.name
            text = text if version.refusal or disk == GONE else version.text
        spare = self._spare if text == self.source.text else None
        if spare is not None:
            self._spare = None
        document = Document(self.options, text, disk, spare)
        own = self._drafts.pop(name, None)
        if own is not None:
            document.take_over(own)
        while len(self._documents) >= MOST_DOCUMENTS:
            gone = next(
                (title for title, held in self._documents.items() if not held.polls), next(iter(self._documents))
            )
            self._keep_draft(gone, self._documents.pop(gone))
        self._documents[name] = document
        return document

    def _keep_draft(self, name: str, document: Document) -> None:
        draft = document.draft
        if draft is None:
            return
        self._drafts[name] = draft
        while sum(len(kept.text.encode()) for kept in self._drafts.values()) > MOST_DRAFT_BYTES:
            self._drafts.popitem(last=False)

    def _draft_of_closed(self, name: str) -> Draft | None:
        """Newest unsaved text of a closed tab, which from now on belongs to the tab that asks."""
        with self._lock:
            for other, held in reversed(self._documents.items()):
                draft = None if other == name or held.is_alive else held.draft
                if draft is not None:
                    held.is_handed_on = True
                    return draft
            left = next((other for other, draft in reversed(self._drafts.items()) if draft.is_left), None)
            return None if left is None else self._drafts.pop(left)


# Start of the explore page with a model file, also a faulty one, a library model, or a text without a file.

LIBRARY = "a library model is not changed; save the text as a file of your own and open that one"
"""Sentence on why a library model cannot be stored."""
NO_FILE = "this text has no file yet; save it as a file and open that one with torsionnet explore FILE"
"""Sentence on why a text without a file cannot be stored."""


def open_documents(
    model: str | os.PathLike[str] = "model.yaml",
    configuration: str = "",
    settings: Mapping[str, str] | None = None,
    pairs: Sequence[ResponseChoice] = (),
    band: tuple[float, float] | None = None,
    overlay: str | os.PathLike[str] | None = None,
    text: str | None = None,
    over_speed: Sequence[str] = (),
    measured: str | os.PathLike[str] | None = None,
    *,
    is_template: bool = False,
) -> tuple[Documents, list[Fault]]:
    """Documents of a page, and the faults of the model they begin with.

    Parameters are those of :func:`torsionnet.app.explore.open_session`. A model with errors is opened to be mended;
    what else was asked for is then left for when it is sound.

    Parameters
    ----------
    is_template : bool
        Whether the text is one to begin with.

    Raises
    ------
    ModelError
        The test is faulty, or the file is no text.
    UsageError
        A name that does not exist, a file that is missing.

    Examples
    --------
    >>> documents, faults = open_documents("amt_rig")
    >>> documents.open("tab")["can_save"], faults
    (False, [])
    """
    path = Path("model.yaml") if text is not None else find_model(model)
    folder = path.parent if text is None else None
    file, why_not = None, NO_FILE
    if text is None:
        is_own = path.resolve() not in {library_file.resolve() for library_file in library_models().values()}
        file, why_not = (disk_file(path), "") if is_own else (None, LIBRARY)
        text = decode(path.read_bytes(), str(path))
    shown = path.name if folder is None else str(model)
    source = TextSource(plain_line_ends(text), path.name, shown, file, why_not, is_template)
    definition, faults = read_text(text, str(path), folder)
    if definition is None:
        test = None if overlay is None else read_overlay(overlay)
        name, orders = "" if overlay is None else Path(overlay).name, None if measured is None else Path(measured)
        options = SessionOptions(
            str(model), path, folder, configuration, dict(settings or {}), tuple(pairs), band, test, name,
            tuple(over_speed), orders,
        )  # fmt: skip
        return Documents(options, source), faults
    session = open_session(
        model, configuration, settings, pairs, band, overlay, None if folder else text, over_speed, measured
    )
    session = replace(session, text=source.text)
    options = replace(SessionOptions.of(session), path=path, band=band)
    return Documents(options, source, session), list(session.base.check())
