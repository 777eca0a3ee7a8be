"""JSON Schema of model files, generated from the specifications of their entries.

Editors complete, explain and check a model file with it (``# yaml-language-server: $schema=torsionnet.schema.json``);
what needs more than one entry at a time (names, dimensions, connections) is left to ``torsionnet check``.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from typing import Any

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import SCALAR_SCHEMA
from torsionnet.base.entries.spec import Schema
from torsionnet.base.packages import imported
from torsionnet.model.definition import Definition
from torsionnet.model.sections import BENCH_FILE

DRAFT = "https://json-schema.org/draft/2020-12/schema"
"""Identifier of the version of JSON Schema in which the schemas are written."""
SCALAR = {**SCALAR_SCHEMA, "description": "a number in SI units, a value with unit, or an expression of parameters"}
"""JSON Schema of an entry that is a number, a quantity or an expression."""


def file_schema(*kinds: type[Declared]) -> Schema:
    """JSON Schema (draft 2020-12) of a file that is one of several kinds; the first one gives it its title."""
    schemas: list[dict[str, Any]] = [dict(kind.schema()) for kind in kinds]
    schema: dict[str, Any] = {"$schema": DRAFT, **schemas[0], "title": f"torsionnet {kinds[0].kind}"}
    if len(kinds) > 1:
        schema["properties"] = {key: value for each in reversed(schemas) for key, value in each["properties"].items()}
        schema["required"] = [key for key in schemas[0]["required"] if all(key in each["required"] for each in schemas)]
        schema["oneOf"] = [_required_entries(kind_schema, schema["required"]) for kind_schema in schemas]
        schema.pop("anyOf", None)
    definitions: Schema = {"scalar": SCALAR}
    for kind in reversed(kinds):
        definitions |= kind.definitions()
    return {**schema, "$defs": definitions}


def _required_entries(schema: Mapping[str, Any], common: Collection[str]) -> Schema:
    """JSON Schema of the entries that one kind of file requires and the others do not."""
    required = [key for key in schema["required"] if key not in common]
    return {"anyOf": schema["anyOf"]} if "anyOf" in schema else {"required": required}


def json_schema() -> Schema:
    """JSON Schema of model files and of the files of test benches."""
    return file_schema(Definition, imported(BENCH_FILE))


def schema_text() -> str:
    """JSON Schema as the text of ``library/torsionnet.schema.json``."""
    return json.dumps(json_schema(), indent=1, ensure_ascii=False) + "\n"
