"""Base class of answers' conclusions whose JSON data are their dataclass fields."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from torsionnet.base.entries.spec import Json
from torsionnet.base.number_text import json_finite

IN_WORDS = {"in_words": True}
"""Metadata of a conclusion's field that is left out of the JSON data, because the sentences contain it."""


class PlainConclusion:
    """Base class of answers' conclusions that are frozen dataclasses with all results in their fields."""

    @property
    def sentences(self) -> tuple[str, ...]:
        """Conclusion in words, a tuple of complete statements for a report."""
        raise NotImplementedError

    def to_data(self) -> Json:
        """Sentences and fields of the conclusion as JSON data, numbers in SI; null for numbers that JSON lacks."""
        data: Json = json_finite({"sentences": list(self.sentences), **plain_data(self)})
        return data


def plain_data(value: Any) -> Any:
    """Conversion of a value to JSON data, dataclasses and mappings to dictionaries, arrays and tuples to lists."""
    if is_dataclass(value):
        return {
            one.name: plain_data(getattr(value, one.name)) for one in fields(value) if not one.metadata.get("in_words")
        }
    if isinstance(value, Mapping):
        return {_key(key): plain_data(one) for key, one in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return [plain_data(one) for one in value] if isinstance(value, tuple | list) else value


def _key(key: Any) -> str:
    return ", ".join(map(str, key)) if isinstance(key, tuple) else str(key)
