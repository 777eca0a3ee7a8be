"""Open file of an editor, and whether it is a model file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from torsionnet.app.language_server.editor_text import EditorText

_KEY = re.compile(r"""^["']?torsionnet["']?[ \t]*:""", re.MULTILINE)
_KEY_IN_BRACES = re.compile(r"""[{,\s]["']?torsionnet["']?\s*:""")
_OTHERS = re.compile(r"""^["']?(vary|model)["']?[ \t]*:""", re.MULTILINE)
"""Expression of the keys of studies, benches, fits and campaigns, which name a model instead of being one."""
_OWN_NAME = re.compile(r"\.torsionnet\.(yaml|yml|json)$", re.IGNORECASE)
_OF_MODELS = re.compile(r"""^["']?(elements|use|parts|ports)["']?[ \t]*:""", re.MULTILINE)

_PARTS = re.compile(r"""^["']?parts["']?[ \t]*:""", re.MULTILINE)
_NO_PARTS = re.compile(r"""^["']?(elements|use|ports)["']?[ \t]*:""", re.MULTILINE)


@dataclass(frozen=True)
class OpenModel:
    """Model file that is open in an editor, with the text as shown there, saved or not."""

    uri: str
    shown: EditorText
    file: str
    folder: Path | None
    addresses: Mapping[Path, str] = field(default_factory=dict, compare=False)
    """Addresses of all files that are open, by their resolved paths."""

    @property
    def text(self) -> str:
        """Text of the file."""
        return self.shown.text


def is_model_text(text: str, file: str) -> bool:
    """Whether a text is that of a model file: it has the key ``torsionnet``, or the file has the ending of models.

    Studies, fits, benches and campaigns have the key too, and are no models.

    >>> is_model_text("torsionnet: 1\\nelements: {}", "plant.yaml"), is_model_text("services: {}", "compose.yaml")
    (True, False)
    >>> is_model_text("torsionnet: 1\\nmodel: amt_rig\\nvary: {}", "study.yaml")
    False
    """
    if _OWN_NAME.search(file):
        return True
    start = text.removeprefix("\ufeff").lstrip()
    if start.startswith("{"):
        return _KEY_IN_BRACES.search(start) is not None
    return _KEY.search(text.removeprefix("\ufeff")) is not None and not names_a_model(text)


def names_a_model(text: str) -> bool:
    """Whether a text is that of a study, fit, bench or campaign, which name a model instead of being one."""
    return _OTHERS.search(text) is not None and _OF_MODELS.search(text) is None


def is_parts_text(text: str) -> bool:
    r"""Whether a text is that of a file of parts, which models include, and which is no model itself.

    >>> is_parts_text("torsionnet: 1\nparts: {}"), is_parts_text("torsionnet: 1\nparts: {}\nelements: {}")
    (True, False)
    """
    return _PARTS.search(text) is not None and _NO_PARTS.search(text) is None
