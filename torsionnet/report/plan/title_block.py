"""Title block of a report and its table of revisions, from ``report: {title_block: ...}`` of a model file."""

from __future__ import annotations

import datetime as dt
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import Listed, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.spec import EntryError, Schema, Spec, entry
from torsionnet.base.errors import Fault, got


class TitleText(Spec[str]):
    """Entry of a text in the title block: may be left blank, and a whole number such as a hull number is a text too."""

    def coerce(self, raw: object) -> str:
        if isinstance(raw, bool) or not isinstance(raw, str | int):
            text = str(raw).lower() if isinstance(raw, bool) else raw
            raise EntryError(f'expected text, {got(raw)}; put it in quotes, as in "{text}"', kind="wrong-form")
        return str(raw).strip()

    @property
    def may_be_empty(self) -> bool:
        return True

    def schema(self) -> Schema:
        return {"type": ["string", "integer", "null"], "description": self.description}

    @property
    def accepted(self) -> str:
        return "str | int"


class IsoDate(TitleText):
    """Entry of a date in ISO form, as 2025-03-31, which may be left blank."""

    def coerce(self, raw: object) -> str:
        if isinstance(raw, dt.date):
            return raw.isoformat()[:10]
        text = raw.strip() if isinstance(raw, str) else str(raw)
        try:
            return dt.date.fromisoformat(text).isoformat() if text else ""
        except ValueError:
            raise EntryError(f"expected a date as 2025-03-31 (year-month-day), {got(raw)}", kind="wrong-form") from None

    def schema(self) -> Schema:
        return {"type": ["string", "null"], "format": "date", "description": self.description}

    @property
    def accepted(self) -> str:
        return "str | datetime.date"


_NAME = "name, or blank to be written by hand"


@dataclass(frozen=True)
class Revision(Declared):
    """Revision of a report: its number or letter, date, what was changed and who signed it.

    Attributes
    ----------
    revision, description : str
    date : str
        ISO, as 2025-03-31; empty if blank.
    prepared, checked, approved : str
        Names; empty if blank.
    """

    article: ClassVar[str] = "a revision"
    form: ClassVar[str] = "{revision: A, date: 2025-03-31, description: first issue}"

    revision: str = entry(TitleText("number or letter of the revision"), "")
    date: str = entry(IsoDate("date of the revision, as 2025-03-31"), "")
    description: str = entry(TitleText("what was changed"), "")
    prepared: str = entry(TitleText(f"who prepared it: {_NAME}"), "")
    checked: str = entry(TitleText(f"who checked it: {_NAME}"), "")
    approved: str = entry(TitleText(f"who approved it: {_NAME}"), "")


_REVISIONS = Listed(
    "revisions of the document, the oldest first",
    Nested("revision of the document", lambda: Revision, "report_revision"),
    form="a list such as [{revision: A, date: 2025-03-31, description: first issue}]",
)


@dataclass(frozen=True)
class TitleBlock(Declared):
    """Title block of a document that is signed: what it is about, whose it is, its revisions and who signs it.

    Every entry may be left out or blank; the document shows a blank field to be filled in by hand.

    Attributes
    ----------
    project, hull, plant, yard, owner, class_society, rules, edition, engine, rating, document_number : str
        A ship has a hull, a plant ashore is named by ``plant``.
    prepared, checked, approved : str
        Names of those who sign.
    revisions : tuple of Revision
        The oldest first; the last one is the revision of the document.

    Examples
    --------
    >>> block = TitleBlock(hull=4711, revisions=[{"revision": 0, "date": "2025-03-31"}])
    >>> block.hull, block.revision
    ('4711', '0')
    """

    article: ClassVar[str] = "a title block"
    form: ClassVar[str] = "the entries of a title block, as {project: ..., hull: ..., document_number: ...}"

    project: str = entry(TitleText("project"), "")
    hull: str = entry(TitleText("hull of the ship, by the number of the yard"), "")
    plant: str = entry(TitleText("instead of hull: plant, for machinery ashore"), "")
    yard: str = entry(TitleText("yard or manufacturer"), "")
    owner: str = entry(TitleText("owner or customer"), "")
    class_society: str = entry(TitleText("classification society"), "")
    rules: str = entry(TitleText("rules or standard by which the calculation is judged"), "")
    edition: str = entry(TitleText("edition of the rules"), "")
    engine: str = entry(TitleText("type of the engine or driver"), "")
    rating: str = entry(TitleText("rated power and speed, as 15 MW at 105 r/min"), "")
    document_number: str = entry(TitleText("number of the document"), "")
    prepared: str = entry(TitleText(f"who prepared the document: {_NAME}; default: the author"), "")
    checked: str = entry(TitleText(f"who checked the document: {_NAME}"), "")
    approved: str = entry(TitleText(f"who approved the document: {_NAME}"), "")
    revisions: tuple[Revision, ...] = entry(_REVISIONS, ())

    def contradictions(self) -> list[Fault]:
        if self.hull and self.plant:
            return [
                Fault(
                    "hull and plant share one field of the title block; give one of them",
                    ("plant",),
                    kind="contradicting-entries",
                )
            ]
        return []

    @property
    def revision(self) -> str:
        """Number or letter of the last revision, empty if there is none."""
        return self.revisions[-1].revision if self.revisions else ""
