"""Tables of the entries of a study file, made from its JSON Schema."""

from __future__ import annotations

from inspect import getdoc
from typing import Any

from page_parts import prose
from schema_pages import entries_table, with_entries

from torsionnet.model.files.model_schema import file_schema
from torsionnet.study.answers.answer import ANSWERS
from torsionnet.study.quantities.quantity import QUANTITIES
from torsionnet.study.space.variations.variation import VARIATIONS
from torsionnet.study.study_file import StudyEntries

KINDS = {"variation": VARIATIONS, "quantity": QUANTITIES, "answer": ANSWERS}

SECTIONS = {
    "variation": "What varies: entries of `vary`",
    "correlation": "Entries of `correlation`",
    "sampling": "`sampling`",
    "quantity": "What is calculated: entries of `quantities`",
    "quantity_limit": "Entries of `limits`",
    "answer": "What is concluded: entries of `answers`",
    "design_bounds": "Entries of `design`",
    "design_target": "Entries of `targets`",
}
"""By the definition in the schema; one with several types has a table for each of them."""


def study_file_page() -> str:
    """Tables of the entries of a study file, then of its sections."""
    schema = file_schema(StudyEntries)
    parts = [entries_table("The file", schema, schema)]
    for name, title in SECTIONS.items():
        definition = schema["$defs"][name]
        parts.append(f"## {title}\n")
        kinds = KINDS.get(name, {})
        parts += [type_section(kind, cls, schema["$defs"][f"{name}_{kind}"], schema) for kind, cls in kinds.items()]
        if not kinds:
            parts.append(_table(with_entries(definition), schema))
    return "\n".join(parts)


def type_section(kind: str, cls: type[Any], definition: dict[str, Any], schema: dict[str, Any]) -> str:
    """Text on a class: its docstring up to the examples, and a table of its entries."""
    rest = {key: entry for key, entry in definition["properties"].items() if key != "type"}
    text = (getdoc(cls) or "").partition("\nExamples\n")[0].strip().replace("``", "`")
    return f"### {kind}\n\n{prose(text)}\n\n" + (_table({**definition, "properties": rest}, schema) if rest else "")


def _table(definition: dict[str, Any], schema: dict[str, Any]) -> str:
    return entries_table("", definition, schema).removeprefix("****\n\n")
