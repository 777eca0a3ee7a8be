"""Rewording of a finished report, in which its own texts are replaced, and those of the model are not."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from torsionnet.base.phrases import phrase
from torsionnet.report.document_tree import (
    Details,
    Facts,
    Heading,
    Listing,
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
    Picture: ("caption",),
    TableGroup: ("title",),
    Heading: ("text",),
    Strong: ("text",),
}
"""Names of fields that hold the report's own texts, by class of the report's tree; formulas, numbers and code have
none."""
REWORDED_COLUMNS = {
    "Action and marking",
    "At",
    "Comparison",
    "Explanation",
    "Kind",
    "Leading term",
    "Limit",
    "Of",
    "Property",
    "Quantity",
    "Speeds not permitted",
    "Type",
    "Verdict",
    "What",
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
                    tuple(self.reworded(row[i]) if own[i] else row[i] for i in range(len(own))) for row in group.rows
                ),
            )
            for group in table.groups
        )
        more = [(self.wording(phrase("… and {count} more", count=table.more)),)] if table.more else []
        said = {name: self.reworded(getattr(table, name)) for name in ("caption", "columns", "notes")}
        return replace(table, **said | {"groups": tuple(groups), "notes": (*said["notes"], *more), "more": 0})
