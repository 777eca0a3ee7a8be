"""MAT v4 and v5 files, through scipy: numbers, also of structures, and texts."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from torsionnet.io.foreign.content import COMPLEX, ROW, Content, Plain, in_memory
from torsionnet.io.foreign.mat_claims import check_claims

MOST = 64
"""Entries of an array of structures that are looked into."""


def load() -> None:
    """Import the library."""
    import scipy.io  # noqa: F401


@contextlib.contextmanager
def opened(path: Path) -> Iterator[Content]:
    """All variables; a field of a structure is named ``structure.field``."""
    from scipy.io import loadmat

    check_claims(path)
    content: dict[str, Any] = loadmat(str(path), squeeze_me=False, simplify_cells=False)
    arrays: list[tuple[str, Any, dict[str, Plain]]] = []
    texts: dict[str, Plain] = {}
    others = []
    for name, value in content.items():
        if name.startswith("__"):
            continue
        found = list(_members(name, value))
        arrays += [(key, *_column(numbers)) for key, numbers in found if numbers.dtype.kind != "U"]
        texts |= {key: "".join(text.ravel()[:1]) for key, text in found if text.dtype.kind == "U"}
        others += [] if found else [name]
    yield in_memory(arrays, texts, others)


def _column(values: Any) -> tuple[Any, dict[str, Plain]]:
    is_row = values.ndim == 2 and values.shape[0] == 1
    given: dict[str, Plain] = {COMPLEX: True} if values.dtype.kind == "c" else {}
    return (values.reshape(-1, 1) if is_row else values), given | ({ROW: True} if is_row else {})


def _members(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    kind = getattr(getattr(value, "dtype", None), "kind", "")
    if kind == "V" and value.dtype.names:
        entries = value.ravel()[:MOST]
        for number, entry in enumerate(entries, 1):
            label = name if len(entries) == 1 else f"{name}{number}"
            for key in value.dtype.names:
                yield from _members(f"{label}.{key}", entry[key])
    elif kind and kind in "fiubcU" and value.size:
        yield name, value
