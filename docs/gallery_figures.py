"""What sphinx-gallery does not know of examples: figures that belong to no pyplot window, and what they depend on."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

from made_files import ROOT, digest_of_all, files_below, imported
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst


def scrape(_: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save every new figure among the variables of an example, and return the reStructuredText that shows them."""
    import matplotlib.pyplot as plt

    for number in plt.get_fignums():
        plt.figure(number).is_in_gallery = True
    found = [value for value in block_vars["example_globals"].values() if isinstance(value, Figure)]
    paths = []
    for figure in found:
        if getattr(figure, "is_in_gallery", False):
            continue
        path = next(block_vars["image_path_iterator"])
        figure.savefig(path, dpi=150)
        figure.is_in_gallery = True
        paths.append(path)
    return figure_rst(paths, gallery_conf["src_dir"])


def _get_sg_image_scraper() -> Any:
    return scrape


# An example is run again where its script has changed, as sphinx-gallery does, or anything that it was made from

RECORD = ROOT / ".cache" / "gallery.json"
READ = ("library", "examples")
"""Folders whose files examples read; to observe which would double the time of the whole build."""
BEGAN = time.time()


def forget_stale() -> None:
    """Let examples run again whose modules, files or packages have changed since they ran."""
    known = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    for ran in (ROOT / "docs" / "gallery").glob("*.py.md5"):
        one = known.get(ran.name.partition(".")[0])
        if one is None or digest_of_all(one["from"]) != one["digest"]:
            ran.unlink()


def record(_conf: Any, script: str | None) -> None:
    """Record what an example that has run was made from; modules that those before it imported count as well."""
    if script is None:
        return
    known = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    others = {name for name in files_below(("examples/*.py",)) if name != f"examples/{Path(script).name}"}
    names = sorted((imported() | files_below(READ)) - others)
    known[Path(script).stem] = {"from": names, "digest": digest_of_all(names, BEGAN)}
    RECORD.parent.mkdir(exist_ok=True)
    RECORD.write_text(json.dumps(known), encoding="utf-8")
