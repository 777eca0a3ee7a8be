"""Record of what the results in a folder depend on (model, study, versions, method), and its differences."""

from __future__ import annotations

import hashlib
import json
import platform
from importlib import metadata
from typing import Any

from torsionnet.base.version import __version__
from torsionnet.study.run.chunks import Chunks, counted_limits
from torsionnet.study.study import Study

FILE_FORMAT = 2
"""Version of the format of the files in a study's folder, raised when older files cannot be read any more."""
LIBRARIES = ("numpy", "scipy", "numba")
"""Packages whose version may change a number in the results of a study."""
INSTALLATION = ("version", "libraries", "machine")
"""Entries that say what calculated the results, by which complete results may differ from what reads them."""
AFTERWARDS = ("name", "limits", "answers")
"""Entries of a study on which no value of a variant depends, so that they may change between runs in one folder.

Limits only where the values of all variants are kept; else variants beyond them are counted as they are calculated.
"""
WORDS = {
    "format": "the form of the files",
    "version": "the version of torsionnet",
    "libraries": "the set of libraries",
    "machine": "the kind of machine",
    "method": "the method of the solver",
    "model": "the model",
    "study": "the study",
    "chunks": "the size of chunks",
    "keep": "what is kept",
    "limits": "the limits",
}


def study_record(study: Study, chunks: Chunks, every: int) -> dict[str, Any]:
    """Record of all that the results of a study depend on, as JSON data; every ``every``-th variant keeps values."""
    text = study.model_text
    limits = {name: limit.to_data() for name, limit in counted_limits(study, every).items()}
    return {
        "format": FILE_FORMAT,
        "version": __version__,
        "libraries": {name: _version(name) for name in LIBRARIES},
        "machine": f"{platform.system()} {platform.machine()}",
        "method": study.method,
        "seed": study.seed,
        "model": {"title": study.model.title, "sha256": hashlib.sha256(text.encode()).hexdigest(), "text": text},
        "study": {key: entry for key, entry in study.to_data().items() if key not in AFTERWARDS},
        "chunks": {"cases": chunks.cases, "count": chunks.count, "size": chunks.size},
        "keep": every,
        "limits": limits,
    }


def record_text(record: dict[str, Any]) -> str:
    """JSON text of a study's record, equal for equal records."""
    return json.dumps(record, indent=1, ensure_ascii=False) + "\n"


def record_differences(kept: dict[str, Any], wanted: dict[str, Any]) -> list[str]:
    """Differences in words between the record in a study's folder and the one wanted now."""
    return [_said(key, kept.get(key), wanted.get(key)) for key in WORDS if kept.get(key) != wanted.get(key)]


def differ_by_installation(kept: dict[str, Any], wanted: dict[str, Any]) -> bool:
    """Whether two records of one major version differ in nothing but what calculated them."""
    same_major = str(kept.get("version")).partition(".")[0] == str(wanted["version"]).partition(".")[0]
    return same_major and all(kept.get(key) == wanted.get(key) for key in WORDS if key not in INSTALLATION)


def _said(key: str, kept: Any, wanted: Any) -> str:
    if key in ("version", "machine", "method", "format"):
        return f"{WORDS[key]} was {kept}, now it is {wanted}"
    if key == "limits" and isinstance(kept, dict) and isinstance(wanted, dict):
        names = [name for name in {**kept, **wanted} if kept.get(name) != wanted.get(name)]
        why = "of so many variants those beyond the limits are counted as they are calculated"
        return f"limits were others ({', '.join(names)}), and {why}"
    if isinstance(kept, dict) and isinstance(wanted, dict):
        names = [name for name in {**kept, **wanted} if kept.get(name) != wanted.get(name) and name != "text"]
        plain = [name for name in names if not isinstance(kept.get(name), dict | list)]
        shown = [f"{name} {kept.get(name)} -> {wanted.get(name)}" for name in plain if name != "sha256"]
        parts = shown if len(shown) == len(names) else [name for name in names if name != "sha256"]
        return f"{WORDS[key]} is another: {', '.join(parts)}" if parts else f"{WORDS[key]} is another"
    return f"{WORDS[key]} is another"


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return ""
