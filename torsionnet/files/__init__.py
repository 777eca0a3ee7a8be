"""Model files: reading them with every fault located, writing them, their JSON Schema and the library.

>>> rig = load("amt_rig")
>>> loads(dump(rig.definition)) == rig
True
"""

from __future__ import annotations

from typing import Any

from torsionnet.files.library import library_entry, library_models
from torsionnet.files.reader import load, loads, read_file
from torsionnet.files.writer import dump

__all__ = ["dump", "json_schema", "library_entry", "library_models", "load", "loads", "read_file"]


def json_schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of model files, for editors and validators."""
    from torsionnet.files.schema import json_schema as generated

    return generated()
