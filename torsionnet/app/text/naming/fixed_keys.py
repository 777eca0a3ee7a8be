"""Keys of the entries that are read as a whole, as a damping measure; they name nothing in a model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from torsionnet.base.entries.spec import Spec


def properties_of(spec: Spec[Any]) -> Mapping[Any, Any]:
    """JSON Schema of each key of an entry that is read as a whole, empty where it has none."""
    schema: Any = spec.schema()
    definitions: Any = spec.definitions()
    for one in (schema, *schema.get("anyOf", ()), *definitions.values()):
        found = definitions.get(one["$ref"].rpartition("/")[2], {}) if "$ref" in one else one
        for inner in (found, *found.get("anyOf", ())):
            if isinstance(inner.get("properties"), Mapping):
                properties: Mapping[Any, Any] = inner["properties"]
                return properties
    return {}
