"""Reading and writing of model files, with every fault located; their JSON Schema and the library.

>>> definition, faults = read_file("amt_rig")
>>> list(definition.parameters)[:2], [fault.severity for fault in faults if fault.severity == "error"]
(['I_MT', 'I_1'], [])
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from torsionnet.model.files.library import library_benches, library_entry, library_models, library_studies
from torsionnet.model.files.reader import read_file

if TYPE_CHECKING:
    from torsionnet.model.definition import Definition

__all__ = ["dump", "json_schema", "library_benches", "library_entry", "library_models", "library_studies", "read_file"]


def dump(definition: Definition, path: str | os.PathLike[str] | None = None) -> str:
    """Text of a model file that reads back to an equal definition, also written to ``path`` if given."""
    from torsionnet.model.files.writer import dump as text_of

    return text_of(definition, path)


def json_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of model files, for editors and validators."""
    from torsionnet.model.files.model_schema import json_schema as generated

    return generated()
