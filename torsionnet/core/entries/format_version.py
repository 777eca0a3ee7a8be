"""Version of the file format, the first entry of every file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from torsionnet.core.errors import Fault

FORMAT_VERSION = 1
"""Number of the version of the file format that this release reads and writes."""
KEY = "torsionnet"
"""Key under which a file states the version of its format."""
VERSION_SCHEMA: dict[str, str | int] = {"const": FORMAT_VERSION, "description": "version of the file format"}


def version_faults(data: Mapping[Any, Any], kind: str) -> list[Fault]:
    """Faults of a file whose format version is missing or unknown; ``kind`` says what it holds: a model, a fit."""
    version = data.get(KEY)
    if version is None:
        text = f"the first entry of a {kind} file is {KEY}: {FORMAT_VERSION}, the version of the format"
        return [Fault(text, kind="missing key", about=KEY)]
    if version != FORMAT_VERSION or isinstance(version, bool):
        shown = f"format {version}" if isinstance(version, int) and not isinstance(version, bool) else repr(version)
        text = f"{KEY}: is the version of the format, {FORMAT_VERSION} for this release; this is {shown}"
        return [Fault(text, (KEY,))]
    return []
