"""Rewording of a finished report, in which its own texts are replaced, and those of the model are not."""

from __future__ import annotations

from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from torsionnet.base.phrases import PLACEHOLDER, Phrase, phrase
from torsionnet.machinery.limits.society_rules import Society
from torsionnet.report.document_tree import (
    BreakableMath,
    Code,
    Details,
    Equations,
    Facts,
    Formula,
    Heading,
    Listing,
    Math,
    NumberText,
    Paragraph,
    Picture,
    Remark,
    Report,
    Section,
    Strong,
    TableBlock,
    TableGroup,
    TitleTable,
)
from torsionnet.report.wording import Wording

TEXT_FIELDS: dict[type, tuple[str, ...]] = {
    Report: ("subtitle", "facts", "sections", "title_block"),
    Section: ("title", "blocks"),
    Details: ("title", "blocks", "instead"),
    Paragraph: ("text",),
    Remark: ("text",),
    Listing: ("items",),
    TableGroup: ("title",),
    Heading: ("text", "unit"),
    Strong: ("text",),
}
"""Names of fields that hold the report's own texts, by class of the report's tree; formulas, numbers and code have
none."""
REWORDED_COLUMNS = {
    "Action",
    "Asked for",
    "Conclusion",
    "Data",
    "At",
    "Comparison",
    "Explanation",
    "From",
    "Kind",
    "Leading term",
    "Limit",
    "Limit in passing",
    "Of",
    "Property",
    "Quantity",
    "Sign",
    "Speeds not permitted",
    "Type",
    "Verdict",
    "To be barred",
    "What",
    "What is compared",
    "What it is",
    "What it sets",
}
"""Headings of columns whose cells hold words of the report, not of the model."""


@dataclass(frozen=True)
class Rewording:
    """Replacement of the texts of a finished report by other words."""

    wording: Wording

    def reworded(self, part: Any) -> Any:
        """Copy of a report, or of a part of it, in the words of the wording."""
        match part:
            case str():
                return self.wording(part)
            case tuple():
                return tuple(map(self.reworded, part))
            case Facts(rows):
                return Facts(tuple((self.wording(word), text) for word, text in rows))
            case None:
                return None
            case TitleTable():
                return self.title_table(part)
            case TableBlock():
                return self.table(part)
            case Picture():
                caption = self.reworded(part.caption)
                alt = self.wording(part.alt)
                if alt == part.alt and caption != part.caption:
                    alt = "".join(piece.latex if isinstance(piece, Math) else str(piece) for piece in caption)
                return replace(part, caption=caption, alt=alt)
            case Heading(text) if text in self.wording.names:
                return part
        return replace(part, **{name: self.reworded(getattr(part, name)) for name in TEXT_FIELDS.get(type(part), ())})

    def title_table(self, table: TitleTable) -> TitleTable:
        return replace(
            table,
            rows=tuple(tuple((self.wording(label), text) for label, text in row) for row in table.rows),
            revision_heads=self.reworded(table.revision_heads),
            signature_heads=self.reworded(table.signature_heads),
            signatures=tuple((self.wording(done), name) for done, name in table.signatures),
        )

    def table(self, table: TableBlock) -> TableBlock:
        heads = [column.text for column in table.columns]
        own = [head in REWORDED_COLUMNS or (heads[0], head) == ("Mode", "Description") for head in heads]
        groups = (
            replace(
                self.reworded(group),
                rows=tuple(
                    tuple(self.reworded(row[i]) if own[i] else self.cell(row[i]) for i in range(len(own)))
                    for row in group.rows
                ),
            )
            for group in table.groups
        )
        more = [(self.wording(phrase("… and {count} more", count=table.more)),)] if table.more else []
        said = {name: self.reworded(getattr(table, name)) for name in ("caption", "columns", "notes")}
        return replace(table, **said | {"groups": tuple(groups), "notes": (*said["notes"], *more), "more": 0})

    def cell(self, cell: Any) -> Any:
        """Cell of a column of names, in which phrases of the report alone are replaced."""
        if isinstance(cell, tuple):
            return tuple(map(self.cell, cell))
        return self.wording(cell) if isinstance(cell, Phrase) else cell


# Replacement of words and symbols in a finished report by those of a classification society.

AS_THEY_ARE = (Math, BreakableMath, Code, NumberText, Formula, Equations)
"""Classes of report parts, such as formulas and code, in which a society's words replace nothing."""
KEPT_FIELDS = frozenset({"name", "figure", "unit", "kind"})
"""Names of fields of a report's parts in which a society's words replace nothing."""


def in_society_words(part: Any, society: Society) -> Any:
    """Copy of a part of a report in which a society's words and symbols replace the report's own.

    Examples
    --------
    >>> from torsionnet.machinery.limits.society_rules import SOCIETIES
    >>> from torsionnet.report.document_tree import Paragraph
    >>> in_society_words(Paragraph(("tau_C is exceeded: barred range",)), SOCIETIES["lr"])
    Paragraph(text=('tau_c is exceeded: restricted speed range',))
    """
    if isinstance(part, Phrase):  # it stays one, with its places
        words = PLACEHOLDER.split(part.template)
        words[::2] = map(society.in_words, words[::2])
        words[1::2] = (f"{{{place}}}" for place in words[1::2])
        values = {place: in_society_words(value, society) for place, value in part.values.items()}
        return Phrase("".join(words), values)
    if isinstance(part, str):
        return society.in_words(part)
    if isinstance(part, tuple):
        return tuple(in_society_words(piece, society) for piece in part)
    if not is_dataclass(part) or isinstance(part, (type, *AS_THEY_ARE)):
        return part
    kept = {field.name: getattr(part, field.name) for field in fields(part) if field.name not in KEPT_FIELDS}
    return replace(part, **{name: in_society_words(value, society) for name, value in kept.items()})
