"""Reading of universal files through pyuff, with two arrays for each dataset, its values and its abscissa."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from torsionnet.signals.foreign.content import Content, ForeignFileError, Plain, memory_content, plain_attributes

FUNCTION_DATASET = 58
"""Number of the type of dataset in universal files that holds a function."""
_MARK = re.compile(rb" {4}-1(?: {74})?[ \r]*(?:\n|$)")
_LINES, _RATE, _NUMBERING = slice(1, 2), slice(3, 4), slice(6, 7)
"""Lines of a dataset 58 after its type, the first and third line of text, and the line with its sequence number."""
_SEQUENCE = slice(15, 20)
"""Columns of the sequence number in its line of a dataset 58."""


def load() -> None:
    """Import pyuff for universal files before the limits of memory and time begin."""
    import pyuff  # noqa: F401


@contextlib.contextmanager
def open_content(path: Path) -> Iterator[Content]:
    """Yield the datasets of a universal file with their entries as attributes, only functions having values."""
    import numpy as np
    import pyuff

    check_end(path.read_bytes())
    datasets = pyuff.UFF(str(path)).read_sets()
    arrays: list[tuple[str, Any, dict[str, Plain]]] = []
    for item in datasets if isinstance(datasets, list) else [datasets]:
        is_function = item.get("type") == FUNCTION_DATASET
        values, axis = (np.asarray(item[key]) if is_function else np.empty(0) for key in ("data", "x"))
        name = str(item.get("id1") or "").strip()
        if is_function and len(values) != item.get("num_pts"):
            raise ForeignFileError(
                f"{name} has {len(values)} values, its heading says {item.get('num_pts')}; the file is damaged"
            )
        arrays += [(name, values, plain_attributes(item)), (name, axis, {})]
    yield memory_content(arrays)


def check_end(raw: bytes) -> None:
    """Refuse a universal file that ends early.

    Marks of datasets come in pairs, and those written here count down to the last.
    """
    marks = [mark.end() for mark in _MARK.finditer(raw)]
    if not marks:
        raise ForeignFileError("there is no whole dataset in it; the file ends early, or is no universal file")
    if len(marks) % 2:
        lines = raw[marks[-1] :].split(b"\n")[:-1]  # the last one may be cut itself
        name = b"".join(lines[_LINES]).decode("latin-1").strip()
        which = f'"{name}"' if name else "the one that begins last"
        raise ForeignFileError(f"the file ends early: of its channels {which} is not whole{_after(lines)}")
    last = raw[marks[-2] :].split(b"\n", 8)
    after = _after(last) if len(marks) > 1 and _is_own(last) else ""
    if after:
        name = b"".join(last[_LINES]).decode("latin-1").strip()
        raise ForeignFileError(f'the file ends early, after the channel "{name}"{after}')


def _is_own(lines: list[bytes]) -> bool:
    """Whether a dataset of a universal file was written by this package, whose sequence numbers count down."""
    return any(line.startswith(b"sampling rate ") for line in lines[_RATE]) or any(
        b" / " in line for line in lines[_LINES]
    )


def _after(lines: list[bytes]) -> str:
    """Words for how many datasets should follow one in a universal file, empty where the file does not say."""
    try:
        left = int(b"".join(lines[_NUMBERING])[_SEQUENCE])
    except ValueError:
        left = 0
    return f", and {left} more {'are' if left > 1 else 'is'} missing" if left > 0 and _is_own(lines) else ""
