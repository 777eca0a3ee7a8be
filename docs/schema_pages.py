"""Tables of the entries of a model file, made from its JSON Schema."""

from __future__ import annotations

from typing import Any

from page_parts import code, prose, table

from torsionnet.model.files.model_schema import json_schema

ELSEWHERE = ("element_", "bench_")
"""Definitions that have pages of their own."""
TITLES = {
    "parameter": "An entry of `parameters`",
    "input": "An entry of `inputs`",
    "sensor": "An entry of `sensors`",
    "alternative": "An alternative of `configurations`",
    "use": "An entry of `use`",
    "part": "An entry of `parts`",
    "operating_point": "`operating_point`",
    "scenario_torques": "An entry of `scenarios`, torques over time",
    "scenario_short_circuit": "An entry of `scenarios`, a short circuit",
    "report": "`report`",
    "viscoelastic": "`material` of a coupling, `silicone` of a viscous damper",
    "rubber_shape_disc": "`geometry` of a coupling, a disc",
    "rubber_shape_bush": "`geometry` of a coupling, a bush",
    "film_gap": "`gap` of a viscous damper",
    "spring_stage": "An entry of `stages` of a dual mass flywheel",
}
PLAIN = {
    "array": "list",
    "boolean": "`true` or `false`",
    "integer": "whole number",
    "number": "number",
    "object": "mapping",
    "string": "text",
}


def file_entries_page() -> str:
    """Tables of the entries of a model file, then of each section with fixed names."""
    schema = json_schema()
    tables = [entries_table("The file", schema, schema)]
    for name, definition in schema["$defs"].items():
        if name in TITLES:
            tables.append(entries_table(TITLES[name], with_entries(definition), schema))
    return "\n".join(tables)


def with_entries(definition: dict[str, Any]) -> dict[str, Any]:
    """Variant of a schema that is a mapping."""
    options = [definition, *definition.get("anyOf", [])]
    return next(option for option in options if "properties" in option)


def entries_table(title: str, definition: dict[str, Any], schema: dict[str, Any]) -> str:
    required = definition.get("required", [])
    rows = []
    for name, entry in definition["properties"].items():
        meaning = entry.get("description") or target(entry, schema).get("description", "")
        rows.append([code(name), kind_of(entry, schema), "required" if name in required else "", prose(meaning)])
    rest = definition.get("additionalProperties")
    if isinstance(rest, dict):
        meaning = rest.get("description") or target(rest, schema).get("description", "")
        rows.append(["*any name*", kind_of(rest, schema), "", prose(meaning)])
    return f"**{title}**\n\n" + table(["entry", "value", "", "meaning"], rows)


def target(entry: dict[str, Any], schema: dict[str, Any]) -> dict[str, Any]:
    reference = entry.get("$ref", "").rpartition("/")[2]
    found = schema["$defs"][reference] if reference else {}
    return found if isinstance(found, dict) else {}


def kind_of(entry: dict[str, Any], schema: dict[str, Any]) -> str:
    """Words for the kind of value that an entry takes."""
    if "const" in entry:
        return code(entry["const"])
    if "enum" in entry:
        return " or ".join(map(code, entry["enum"]))
    if "$ref" in entry:
        return "value" if entry["$ref"].endswith("/scalar") else kind_of(target(entry, schema), schema)
    if "anyOf" in entry:
        return " or ".join(dict.fromkeys(kind_of(option, schema) for option in entry["anyOf"]))
    kinds = entry.get("type", "object")
    listed = [kinds] if isinstance(kinds, str) else kinds
    if {"number", "string"} <= set(listed):
        return "value"
    return " or ".join(PLAIN.get(kind, kind) for kind in listed if kind != "null")
